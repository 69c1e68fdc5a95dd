// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <utility>
#include <weft/data/matrix.hpp>
#include <weft/data/template.hpp>

namespace weft::testing {

/// Moves a template's texture into a larger image of width_px x height_px, with its first pixel at
/// `corner_px` (u, v, integers). The mask of the remaining pixels is 0.
inline void put_in_atlas(Template& templ, std::int64_t width_px, std::int64_t height_px,
                         const Eigen::RowVector2d& corner_px) {
  const std::int64_t rows = templ.texture.dim(0), columns = templ.texture.dim(1);
  const auto left = static_cast<std::int64_t>(corner_px[0]);
  const auto top = static_cast<std::int64_t>(corner_px[1]);
  Array<std::uint8_t> texture({height_px, width_px}, 0), mask({height_px, width_px}, 0);
  for (std::int64_t y = 0; y < rows; ++y) {
    std::copy_n(templ.texture.row(y), columns, texture.row(top + y) + left);
    std::copy_n(templ.mask.row(y), columns, mask.row(top + y) + left);
  }
  templ.texture = std::move(texture);
  templ.mask = std::move(mask);
  templ.flat_px.matrix<2>().rowwise() += corner_px;
}

}  // namespace weft::testing
