// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <weft/data/record.hpp>

namespace weft {

/// A pinhole camera without distortion: u = fx X / Z + cx, v = fy Y / Z + cy; x right, y down, z
/// forward; pixel centres at integer coordinates.
struct Camera {
  static constexpr const char* kType = "camera/1";
  double fx = 0.0;             ///< [] px
  double fy = 0.0;             ///< [] px
  double cx = 0.0;             ///< [] px
  double cy = 0.0;             ///< [] px
  std::int64_t width_px = 0;   ///< [] px
  std::int64_t height_px = 0;  ///< [] px
  Others others = {};          ///< what else the record has

  /// Whether a pixel lies in the image, whose border is half a pixel beyond the outer centres.
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

/// How much is known of a camera without a calibration. It goes with the camera's record, in the
/// arrays x.weft.focal_sd_px, x.weft.centre_sd_px and x.weft.assumed_from.
struct CameraAssumption {
  double focal_sd_px = 0.0;               ///< [px] standard deviation of fx and fy
  double cx_sd_px = 0.0, cy_sd_px = 0.0;  ///< [px] of the principal point
  std::string from;                       ///< where the focal length comes from, in words

  /// That of a camera; nothing for one that was calibrated.
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
