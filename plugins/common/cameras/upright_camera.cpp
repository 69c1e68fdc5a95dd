// SPDX-License-Identifier: Apache-2.0
#include "common/cameras/upright_camera.hpp"

#include <weft/images/orientation.hpp>

namespace weft::cameras {
namespace {

std::string size_text(std::int64_t width, std::int64_t height) {
  return std::to_string(width) + " x " + std::to_string(height) + " px";
}

/// Exchanges the axes, then reverses those that `turned` specifies, as the pixels are. The radial
/// terms are the same in all directions; (p2, p1) are a vector in the image.
CameraFile rotated(const CameraFile& file, const Turns& turned) {
  CameraFile result = file;
  Camera& camera = result.camera;
  const bool has_tangential = file.model == Distortion::brown && file.coefficients.size() > 3;
  double p1 = has_tangential ? file.coefficients[2] : 0.0;
  double p2 = has_tangential ? file.coefficients[3] : 0.0;
  if (turned.sideways) {
    std::swap(camera.fx, camera.fy);
    std::swap(camera.cx, camera.cy);
    std::swap(camera.width_px, camera.height_px);
    std::swap(p1, p2);
  }
  if (turned.columns) {
    camera.cx = static_cast<double>(camera.width_px) - 1.0 - camera.cx;
    p2 = -p2;
  }
  if (turned.rows) {
    camera.cy = static_cast<double>(camera.height_px) - 1.0 - camera.cy;
    p1 = -p1;
  }
  if (has_tangential) {
    result.coefficients[2] = p1;
    result.coefficients[3] = p2;
  }
  return result;
}

}  // namespace

Result<UprightCamera> upright_camera(const CameraFile& camera, const std::string& camera_path,
                                     const StoredImages& stored, const std::string& name) {
  const Turns turned = turns(stored.orientation);
  const auto has_size = [&](std::int64_t width, std::int64_t height) {
    return camera.camera.width_px == width && camera.camera.height_px == height;
  };
  const cv::Size size = stored.size_px;
  const cv::Size upright = turned.sideways ? cv::Size(size.height, size.width) : size;
  const bool fits_stored = has_size(size.width, size.height);
  const bool fits_upright = has_size(upright.width, upright.height);
  if (!fits_stored && !fits_upright) {
    std::string is = name + ": is " + size_text(size.width, size.height);
    if (stored.orientation != 1) {
      is = name + ": stores " + size_text(size.width, size.height) + " and " +
           orientation_text(stored.orientation) + " to " + size_text(upright.width, upright.height);
    }
    return Error{Errc::invalid_data,
                 is + ", but " + camera_path + " describes images of " +
                     size_text(camera.camera.width_px, camera.camera.height_px) +
                     ": use the images that were calibrated, or correct the camera file"};
  }
  if (turned.mirrored()) {
    return Error{Errc::unsupported,
                 name + ": " + orientation_text(stored.orientation) +
                     " to be upright, which no rotation of the camera does: save it upright and "
                     "without orientation, or turn off mirroring in the camera"};
  }
  if (stored.orientation == 1 || !fits_stored) return UprightCamera{camera, false};
  return UprightCamera{rotated(camera, turned), true};
}

}  // namespace weft::cameras
