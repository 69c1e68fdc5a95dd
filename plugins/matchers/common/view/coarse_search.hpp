// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "common/view/picture.hpp"
#include "common/view/predicted_view.hpp"

namespace weft::view {

/// Level at which the whole view is looked for.
inline constexpr int kSheetLevel = kLevels - 1;

/// The displacement of the whole view that fits the image best.
struct CoarseShift {
  int dx = 0, dy = 0;        ///< [] px of kSheetLevel
  float correlation = 0.0F;  ///< [] -1 to 1, normalised; 0 where nothing could be compared

  /// In px of the image.
  Eigen::Vector2d by_px() const {
    return static_cast<double>(1 << kSheetLevel) * Eigen::Vector2d(dx, dy);
  }
};

/// Tries all whole displacements up to a reach by normalised correlation over the rendered part.
class CoarseSearch {
 public:
  /// `search_px` is the reach in px of the image. A displacement must exceed the correlation of a
  /// nearer one by a margin, because a texture may repeat itself. Half of the rendered part must
  /// stay inside the image.
  CoarseShift find(const PredictedView& view, const Pyramid& image, double search_px);

 private:
  void lay_out(const ViewLevel& view, int reach_px, const Picture& image);
  float correlation_at(int dx, int dy) const;

  int columns_ = 0, rows_ = 0;               ///< size of the view, columns rounded up to a multiple
                                             ///< of the SIMD width
  int stride_ = 0;                           ///< row length of the image
  std::vector<float> weight_, grey_;         ///< [rows * columns] 1 where rendered, and its grey
                                             ///< level
  std::vector<float> image_, image_weight_;  ///< the image around the view, 0 where there is none
  int reach_ = 0;
  float drawn_ = 0.0F;
};

}  // namespace weft::view
