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

/// Tries all whole displacements up to a reach by normalised correlation over what is drawn.
class CoarseSearch {
 public:
  /// `search_px` is the reach in px of the image. A displacement must beat a nearer one by some
  /// correlation: a print may repeat itself. Half of what is drawn must stay inside the image.
  CoarseShift find(const PredictedView& view, const Pyramid& image, double search_px);

 private:
  void lay_out(const ViewLevel& view, int reach_px, const Picture& image);
  float correlation_at(int dx, int dy) const;

  int columns_ = 0, rows_ = 0;               ///< of the view, columns up to a whole number of lanes
  int stride_ = 0;                           ///< of the image
  std::vector<float> weight_, grey_;         ///< [rows * columns] 1 where drawn, and its grey level
  std::vector<float> image_, image_weight_;  ///< the image around the view, 0 where there is none
  int reach_ = 0;
  float drawn_ = 0.0F;
};

}  // namespace weft::view
