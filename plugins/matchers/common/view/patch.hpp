// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "common/view/picture.hpp"
#include "common/view/predicted_view.hpp"

namespace weft::view {

/// Where a patch was found.
struct Alignment {
  enum class End { converged, wandered, left_image, no_contrast };
  End end = End::wandered;
  float dx = 0.0F, dy = 0.0F;  ///< [] px of the level, from the place in the view
  float correlation = 0.0F;    ///< [] -1 to 1, normalised
};

/// A piece of a view, to be found in an image by moving it. Let i be the grey levels of the image
/// under the patch and t those of the patch. Both are reduced by the plane that fits them best and
/// divided by their norm. The search minimises the sum of (i(d) - t)^2 over the displacement d. It
/// uses the inverse compositional scheme of Baker and Matthews (IJCV 2004, equations 18 to 24). Its
/// slopes are those of t, made orthogonal to t and to such planes. Therefore brightness, contrast
/// and a shade that grows to one side, as on folds, have no influence.
class Patch {
 public:
  static constexpr int kSide = 12;  ///< [] px
  static constexpr int kSize = kSide * kSide;

  enum class Fit { usable, not_drawn, flat };

  static constexpr int kBordered = kSide + 2;

  /// Takes the piece whose first pixel is (x,y) of this level of the image. The piece and a border
  /// of one pixel must have been rendered, and it must have structure along all directions.
  Fit take(const ViewLevel& view, int x, int y);
  /// The same of an image.
  Fit take(const Picture& image, int x, int y);
  /// The same of a piece with its border.
  Fit take(const Samples& samples, int x, int y);

  /// Looks for it in `image`, beginning at a displacement; may go `reach_px` away from there.
  Alignment find_in(const Picture& image, float dx, float dy, float reach_px) const;

  /// Correlation of the patch with the image under it, moved by (dx,dy); 0 beyond the image.
  float correlation_at(const Picture& image, float dx, float dy) const;

  /// Covariance [px^2] of the place, where all that differs between patch and image is noise.
  Eigen::Matrix2d covariance_px2(float correlation) const;
  /// Standard deviation [px] of the place along its worst direction, where all that differs
  /// between patch and image is noise.
  float deviation_px(float correlation) const;

 private:
  bool is_inside(const Picture& image, float place_x, float place_y) const;
  Fit take_rows(const float* first, int stride);

  int x_ = 0, y_ = 0;  ///< px of its first pixel
  ///< by pixel, two rows after two rows: eight of the one, eight of the other, four of each
  alignas(64) std::array<float, kSize> t_{}, slope_x_{}, slope_y_{};
  float inverse_xx_ = 0.0F, inverse_xy_ = 0.0F, inverse_yy_ = 0.0F;  ///< inverse of the normal
                                                                     ///< matrix
  float least_slope2_ = 0.0F;  ///< [1/px^2] smallest eigenvalue of the normal matrix
};

}  // namespace weft::view
