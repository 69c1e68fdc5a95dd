// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>
#include <weft/core/params.hpp>
#include <weft/data/ground_truth.hpp>

#include "common/cameras/calibrated_camera.hpp"

namespace weft::images {

/// Depth images, aligned to the colour images: one channel of 16 bits, 0 where nothing was
/// measured.
class DepthFiles {
 public:
  void declare(Params& p);
  bool is_given() const { return !pattern_.empty(); }

  /// Finds the files, one a frame of the same stem. Fails as files_by_stem() does.
  Result<void> open(const std::vector<std::string>& stems);

  /// Adds the depth of the frame to its truth, without the lens's distortion; a frame that has no
  /// other truth gets one of the kind "depth" without points. Nothing happens without a file.
  Result<void> add_to(std::optional<GroundTruth>& truth, const std::string& stem,
                      const cameras::CalibratedCamera& camera) const;

 private:
  std::string pattern_;
  double unit_m_ = 0.001;
  std::map<std::string, std::string> path_of_;  ///< by stem
};

}  // namespace weft::images
