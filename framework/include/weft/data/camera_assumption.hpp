// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <weft/data/camera.hpp>

namespace weft {

/// How much is known of a camera that nobody calibrated. It goes with the camera's record, in the
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
