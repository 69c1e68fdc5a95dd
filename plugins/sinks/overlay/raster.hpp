// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
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

/// The surface of the triangles and the lines along their sides.
class Paint {
 public:
  Paint() = default;
  /// `texture` is BGR and not empty; colours fade to `blank`.
  Paint(const cv::Mat& texture, const cv::Scalar& blank, double line_px);

  cv::Scalar line_colour;  ///< BGR

 private:
  friend class Raster;
  cv::Mat4b texels_;  ///< BGR and 0; the last column and row twice
  cv::Scalar blank_;
  double line_px_ = 1.0;
};

/// The colour of the nearest surface at each pixel of a canvas.
class Raster {
 public:
  /// Removes everything. Reuses the memory if the size stays.
  void clear(cv::Size size);

  /// Renders a triangle where nothing nearer is rendered yet, with texture in perspective. Side k,
  /// opposite to corner k, is a line where `sides[k]` is set.
  void draw(const std::array<Corner, 3>& corners, const std::array<bool, 3>& sides,
            const Paint& paint);

  /// Lays the surfaces over a BGR canvas, which has the size of this raster divided by `finer`,
  /// 1 or 2. Each of its pixels is the mean of finer x finer pixels.
  template <int finer>
  void lay_over(cv::Mat& canvas) const;

  /// 1/m, 0 where nothing is.
  float nearness(cv::Point at) const { return nearness_(at); }
  /// BGR; undefined where nothing is.
  cv::Vec3b colour(cv::Point at) const;

 private:
  cv::Size size_;
  cv::Mat1f nearness_;
  cv::Mat1i colour_;   ///< blue in the lowest byte
  cv::Rect window_{};  ///< contains everything rendered
};

}  // namespace weft::overlay
