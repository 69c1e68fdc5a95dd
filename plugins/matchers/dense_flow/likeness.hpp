// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <functional>
#include <vector>
#include <weft/geometry/types.hpp>

#include "common/view/picture.hpp"
#include "common/view/predicted_view.hpp"

namespace weft::dense_flow {

/// The share of the visible texture that the image shows at the place that a shape predicts. It is
/// counted in square cells of the texture, 48 along its diagonal. A cell is unlike if its rendered
/// and its seen grey levels correlate by less than 0.5. Its weight is the contrast of its rendered
/// pixels, so that blank parts do not count. If the image has less than 0.3 of its usual contrast,
/// in median over the cells, a smooth object such as a hand covers the texture. Hidden cells then
/// count a fifth.
class Likeness {
 public:
  /// PredictedView::texel_map() of a face.
  using TexelMap = std::function<Eigen::Matrix3d(std::int32_t face)>;

  /// Share [] 0 to 1 of the contrast in unlike cells; 0 where nothing has contrast. `view` is level
  /// `k` with faces, and `image` has the same level and is read `shift_px` away; `flat_px` [V,2]
  /// are the texels of the vertices.
  double unlike_share(const view::ViewLevel& view, int k, const view::Picture& image,
                      const Eigen::Vector2d& shift_px, const Points2& flat_px,
                      const TexelMap& texel_map);

 private:
  struct Cell {
    void add(double drawn, double seen);
    double count = 0.0, sum_drawn = 0.0, sum_seen = 0.0;
    double sum_drawn2 = 0.0, sum_seen2 = 0.0, sum_both = 0.0;

    // Sums of squares and products about the means.
    double drawn2() const { return sum_drawn2 - sum_drawn * sum_drawn / count; }
    double seen2() const { return std::max(sum_seen2 - sum_seen * sum_seen / count, 0.0); }
    double both() const { return sum_both - sum_drawn * sum_seen / count; }
    bool has_contrast() const;
  };
  std::vector<Cell> cells_;
  std::vector<double> contrasts_;
};

}  // namespace weft::dense_flow
