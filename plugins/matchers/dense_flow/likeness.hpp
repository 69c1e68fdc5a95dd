// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>
#include <weft/geometry/types.hpp>

#include "common/view/picture.hpp"
#include "common/view/predicted_view.hpp"

namespace weft::dense_flow {

/// How much of what the texture shows is in the image where a shape says. Counted in square cells
/// of the texture, 48 along its diagonal: a cell is unlike if its drawn and its seen grey levels
/// correlate by less than 0.5, and weighs as much as its drawn pixels differ from their mean, so
/// that blank parts do not count.
class Likeness {
 public:
  /// The texel [px] that a pixel of the level shows.
  using TexelAt = std::function<Eigen::RowVector2d(int x, int y)>;

  /// Share [] 0 to 1 of the contrast that is in unlike cells; 0 where nothing has contrast. `view`
  /// has faces, `image` is of the same level and is looked at `shift_px` away; `flat_px` [V,2] are
  /// the texels of the vertices.
  double unlike_share(const view::ViewLevel& view, const view::Picture& image,
                      const Eigen::Vector2d& shift_px, const Points2& flat_px,
                      const TexelAt& texel_at);

 private:
  struct Cell {
    double count = 0.0, drawn = 0.0, seen = 0.0, drawn2 = 0.0, seen2 = 0.0, both = 0.0;
  };
  std::vector<Cell> cells_;
};

}  // namespace weft::dense_flow
