// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <opencv2/core.hpp>

namespace weft::overlay {

/// A corner of a triangle on a canvas, and what is interpolated from there.
struct Corner {
  cv::Point2d at_px;
  double nearness = 0.0;  ///< [] 1/m, of the distance along the optical axis
  cv::Point2d uv_px;      ///< [] px of the texture
  double light = 1.0;     ///< [] factor of the colour
  double pallor = 0.0;    ///< [] 0 to 1, how far the colour fades
};

/// The nearest surface at each pixel of a canvas. Where nothing is, only `nearness` is set.
struct Raster {
  explicit Raster(cv::Size size);

  cv::Mat1f nearness;  ///< 1/m, 0 where nothing is
  cv::Mat2f uv_px;
  cv::Mat1f light, pallor;
  cv::Mat1f line;   ///< 0 to 1, how much of an edge covers the pixel
  cv::Rect window;  ///< contains everything rendered
};

/// Renders a triangle where nothing nearer is rendered yet, with texture in perspective. Side k,
/// opposite to corner k, is a line of `line_px` width where `sides[k]` is set.
void draw_triangle(Raster& raster, const std::array<Corner, 3>& corners,
                   const std::array<bool, 3>& sides, double line_px);

}  // namespace weft::overlay
