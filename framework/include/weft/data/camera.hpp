// SPDX-License-Identifier: Apache-2.0
#pragma once

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

}  // namespace weft
