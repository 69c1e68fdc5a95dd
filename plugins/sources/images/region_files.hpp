// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>
#include <weft/core/params.hpp>
#include <weft/data/image.hpp>

#include "common/cameras/calibrated_camera.hpp"

namespace weft::images {

/// Masks of the places in the frames where the object may be visible: one channel, 0 elsewhere.
class RegionFiles {
 public:
  void declare(Params& p);
  bool is_given() const { return !pattern_.empty(); }

  /// Finds the files, one for each frame and of the same stem. Fails on a frame without a mask and
  /// as files_by_stem() does.
  Result<void> open(const std::vector<std::string>& stems);

  /// The region of the frame, without the lens's distortion; nothing where no masks were given.
  Result<std::optional<Region>> read(const std::string& stem,
                                     const cameras::CalibratedCamera& camera) const;

 private:
  std::string pattern_;
  std::map<std::string, std::string> path_of_;  ///< by stem
};

}  // namespace weft::images
