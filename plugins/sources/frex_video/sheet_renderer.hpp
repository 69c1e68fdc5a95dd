// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "common/scene/mip_texture.hpp"

namespace weft::frex_video {

/// A vertex of the sheet as the camera sees it.
struct ScreenVertex {
  double x_px = 0.0, y_px = 0.0;  ///< px, image
  double depth_m = 0.0;           ///< m, > 0
  double u_px = 0.0, v_px = 0.0;  ///< px, texture
  double light = 0.0;             ///< [] cosine between the printed side and the light
};

/// What the camera sees of the sheet, without a background.
struct SheetLayer {
  cv::Mat3f colour;    ///< [H,W] BGR times coverage
  cv::Mat1f coverage;  ///< [H,W] 0 to 1
  cv::Mat1f depth_m;   ///< [H,W] m at the pixel's centre, 0 where it sees no sheet
  cv::Mat2f
      template_px;  ///< [H,W] texture coordinates there, NaN where it sees none of the texture
};

/// Draws a mesh of the sheet over a depth buffer, by 3 x 3 rays a pixel, so that folds hide what
/// lies behind. Around the texture and behind it the paper is white.
class SheetRenderer {
 public:
  static constexpr int kRays = 3;

  SheetRenderer(scene::MipTexture texture, cv::Size image_px, double ambient)
      : texture_(std::move(texture)), image_px_(image_px), ambient_(static_cast<float>(ambient)) {}

  /// `mesh` is a grid of vertices, row by row, `columns` in a row.
  SheetLayer render(const std::vector<ScreenVertex>& mesh, int columns) const;

  const scene::MipTexture& texture() const { return texture_; }

 private:
  scene::MipTexture texture_;
  cv::Size image_px_;
  float ambient_;
};

}  // namespace weft::frex_video
