// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <weft/data/record.hpp>

namespace weft {

/// A pinhole camera without distortion: u = fx X / Z + cx, v = fy Y / Z + cy. In the camera frame,
/// x is right, y down and z forward. Pixel centres are at integer coordinates.
struct Camera {
  static constexpr const char* kType = "camera/1";
  double fx = 0.0;             ///< [] px, focal length along u
  double fy = 0.0;             ///< [] px, focal length along v
  double cx = 0.0;             ///< [] px, principal point along u
  double cy = 0.0;             ///< [] px, principal point along v
  std::int64_t width_px = 0;   ///< [] px, width of the image
  std::int64_t height_px = 0;  ///< [] px, height of the image
  Others others = {};          ///< further arrays of the record

  /// Returns whether a pixel lies in the image. The border of the image is half a pixel beyond the
  /// outer pixel centres.
  bool shows(double x_px, double y_px) const {
    return x_px >= -0.5 && x_px <= static_cast<double>(width_px) - 0.5 && y_px >= -0.5 &&
           y_px <= static_cast<double>(height_px) - 0.5;
  }

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit(self.fx, Field{"fx", "", "px", "focal length along x"});
    visit(self.fy, Field{"fy", "", "px", "focal length along y"});
    visit(self.cx, Field{"cx", "", "px", "principal point, x"});
    visit(self.cy, Field{"cy", "", "px", "principal point, y"});
    visit(self.width_px, Field{"width", "", "px", "width of the image"});
    visit(self.height_px, Field{"height", "", "px", "height of the image"});
  }
};

/// Uncertainty of a camera without a calibration. It is stored in the camera's record as
/// x.weft.focal_sd_px, x.weft.centre_sd_px and x.weft.assumed_from.
struct CameraAssumption {
  double focal_sd_px = 0.0;               ///< [] px, standard deviation of fx and fy
  double cx_sd_px = 0.0, cy_sd_px = 0.0;  ///< [] px, standard deviation of the principal point
  std::string from;                       ///< source of the focal length, as text

  /// Returns the uncertainty stored with a camera; nothing for a calibrated camera.
  static std::optional<CameraAssumption> of(const Camera& camera) {
    const auto* focal_sd_px = camera.others.find<double>("x.weft.focal_sd_px");
    const auto* centre_sd_px = camera.others.find<double>("x.weft.centre_sd_px");
    const auto* from = camera.others.find<std::uint8_t>("x.weft.assumed_from");
    if (focal_sd_px == nullptr || centre_sd_px == nullptr || from == nullptr) return std::nullopt;
    if (focal_sd_px->size() != 1 || centre_sd_px->size() != 2) return std::nullopt;
    return CameraAssumption{*focal_sd_px->data(), centre_sd_px->data()[0], centre_sd_px->data()[1],
                            std::string(from->data(), from->data() + from->size())};
  }

  void add_to(Camera& camera) const {
    Array<double> centre_sd_px({2});
    centre_sd_px(0) = cx_sd_px;
    centre_sd_px(1) = cy_sd_px;
    Array<std::uint8_t> text({static_cast<std::int64_t>(from.size())});
    std::copy(from.begin(), from.end(), text.data());
    camera.others.set("x.weft.focal_sd_px", make_scalar(focal_sd_px));
    camera.others.set("x.weft.centre_sd_px", std::move(centre_sd_px));
    camera.others.set("x.weft.assumed_from", std::move(text));
  }
};

}  // namespace weft
