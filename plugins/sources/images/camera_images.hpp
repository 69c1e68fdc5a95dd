// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>
#include <weft/core/params.hpp>
#include <weft/core/result.hpp>
#include <weft/data/image.hpp>
#include <weft/sdk/call.hpp>

#include "common/assumed_cameras/assumed_camera.hpp"
#include "common/cameras/calibrated_camera.hpp"

namespace weft::images {

/// The images of one camera: of a calibrated one, or of one that is assumed. Those of an assumed
/// one may have several sizes; each is then in the middle of a canvas as large as the largest.
class CameraImages {
 public:
  /// `camera`, `focal_by_side`, `focal_by_side_sd` and `longest_px`.
  void declare(Params& p);
  /// An error where the parameters contradict each other.
  Result<void> check() const { return cameras::check(focal_, is_assumed()); }

  bool is_assumed() const { return camera_path_ == "auto"; }
  /// Images have several sizes.
  bool have_canvas() const { return has_canvas_; }
  /// Known once fit() was called.
  const cameras::CalibratedCamera& camera() const { return camera_; }

  /// Reads the camera file, where there is one; `sizes_alone`: without the maps of undistortion.
  Result<void> read_camera(bool sizes_alone);
  /// Fits the camera to these images; an assumed one is made of all of them. Fails as
  /// camera_of_files() and assume_camera() do.
  Result<void> fit(const std::vector<std::string>& paths);
  /// Logs how images become those of the camera, and warns of one that is assumed.
  void report(const Call& call, const std::string& images) const;

  struct Frame {
    Image image;
    std::optional<Region> region;  ///< where the photograph is, if it does not fill the canvas
    std::string damage;            ///< the damage that the decoder of a JPEG found
  };
  Result<Frame> read(const std::string& path, const std::string& stem) const;

 private:
  std::string camera_path_;
  cameras::KnownFocal focal_;
  int longest_px_ = 0;
  cameras::CalibratedCamera camera_;
  bool has_canvas_ = false;
};

}  // namespace weft::images
