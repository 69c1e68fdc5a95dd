// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/data/template.hpp>

namespace weft {

/// A part of the texture between pixel borders; four columns extend from -0.5 to 3.5.
struct TextureBox {
  double u0 = 0.0, u1 = 0.0;  ///< [] px of the texture, left and right border
  double v0 = 0.0, v1 = 0.0;  ///< [] px of the texture, upper and lower border

  bool operator==(const TextureBox&) const = default;
  double width_px() const { return u1 - u0; }
  double height_px() const { return v1 - v0; }
  bool contains(double u, double v) const { return u >= u0 && u <= u1 && v >= v0 && v <= v1; }
  TextureBox grown(double margin_px) const {
    return {u0 - margin_px, u1 + margin_px, v0 - margin_px, v1 + margin_px};
  }
};

namespace detail {

inline bool is_blank(const std::uint8_t* mask, std::int64_t count) {
  return count <= 0 || (*mask == 0 && std::memcmp(mask, mask + 1, to_index(count - 1)) == 0);
}

}  // namespace detail

/// The bounding box of the object's pixels according to the template's mask; the whole texture
/// without a mask.
inline TextureBox object_box(const Template& templ) {
  const std::int64_t height = templ.texture.dim(0), width = templ.texture.dim(1);
  std::int64_t top = 0, bottom = height, left = width, right = 0;
  const auto& mask = templ.mask;
  if (mask.size() == height * width) {
    while (top < height && detail::is_blank(mask.row(top), width)) ++top;
    while (bottom > top && detail::is_blank(mask.row(bottom - 1), width)) --bottom;
    for (std::int64_t y = top; y < bottom; ++y) {
      const std::uint8_t* row = mask.row(y);
      const auto belongs = [](std::uint8_t pixel) { return pixel != 0; };
      if (!detail::is_blank(row, left)) left = std::find_if(row, row + left, belongs) - row;
      if (detail::is_blank(row + right, width - right)) continue;
      const auto last = std::find_if(std::make_reverse_iterator(row + width),
                                     std::make_reverse_iterator(row + right), belongs);
      right = last.base() - row;
    }
  }
  if (left >= right) top = left = 0, bottom = height, right = width;
  return {static_cast<double>(left) - 0.5, static_cast<double>(right) - 0.5,
          static_cast<double>(top) - 0.5, static_cast<double>(bottom) - 0.5};
}

namespace detail {

/// Returns whether two faces of a template at rest turn away from each other, as on a box. No view
/// shows all faces of such an object.
inline bool turns_away(const Template& templ) {
  constexpr double kLeastCosine = -0.1;  // beyond noise of a right angle
  const auto& places_m = templ.vertices_m;
  bool is_level = true;
  for (std::int64_t v = 1; v < places_m.rows() && is_level; ++v) {
    is_level = places_m(v, 2) == places_m(0, 2);
  }
  std::array<double, 3> first{};
  double first2 = 0.0;
  for (std::int64_t f = 0; f < templ.faces.rows() && !is_level; ++f) {
    std::array<std::array<double, 3>, 2> sides;
    for (const std::int64_t k : {0, 1}) {
      for (const std::int64_t axis : {0, 1, 2}) {
        sides[to_index(k)][to_index(axis)] =
            places_m(templ.faces(f, k + 1), axis) - places_m(templ.faces(f, 0), axis);
      }
    }
    const auto& [a, b] = sides;
    const std::array normal{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
                            a[0] * b[1] - a[1] * b[0]};
    const double length2 = normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2];
    if (!(length2 > 0.0)) continue;
    if (first2 == 0.0) first = normal, first2 = length2;
    const double dot = first[0] * normal[0] + first[1] * normal[1] + first[2] * normal[2];
    if (dot < kLeastCosine * std::sqrt(first2 * length2)) return true;
  }
  return false;
}

}  // namespace detail

/// Cells of an object's surface, twelve along the diagonal of its box, independent of the mesh.
/// They are squares of the texture. If some faces turn away from others at rest, they are cubes
/// around the surface at rest. Neighbours in the texture can then be on opposite sides of the
/// object.
class SurfaceCells {
 public:
  /// A place in px of the texture, with 0 as the third number, or in m at rest.
  using Place = std::array<double, 3>;
  enum Cell : std::uint8_t { kNothing = 0, kSeen = 1, kShown = 2 };

  /// The template and `cells`, whose former contents do not matter, must outlive the object.
  SurfaceCells(const Template& templ, std::vector<Cell>& cells)
      : at_rest_(detail::turns_away(templ)),
        places_(at_rest_ ? templ.vertices_m : templ.flat_px),
        cells_(cells) {
    constexpr double kCellsAlongDiagonal = 12.0;
    Place high{};
    for (std::int64_t v = 0; v < places_.rows(); ++v) {
      const Place place = place_of(v);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        low_[axis] = v == 0 ? place[axis] : std::min(low_[axis], place[axis]);
        high[axis] = v == 0 ? place[axis] : std::max(high[axis], place[axis]);
      }
    }
    const Place size{high[0] - low_[0], high[1] - low_[1], high[2] - low_[2]};
    const double diagonal = std::sqrt(size[0] * size[0] + size[1] * size[1] + size[2] * size[2]);
    cell_ = std::max(diagonal / kCellsAlongDiagonal, 1e-9);
    columns_ = along(size[0]) + 1;
    rows_ = along(size[1]) + 1;
    cells_.assign(to_index(columns_ * rows_ * (along(size[2]) + 1)), kNothing);
  }

  bool are_at_rest() const { return at_rest_; }

  Place place_of(std::int64_t vertex) const {
    return {places_(vertex, 0), places_(vertex, 1), at_rest_ ? places_(vertex, 2) : 0.0};
  }

  /// Marks the cell of a place as visible.
  void see(const Place& place) { mark(place, kNothing, kSeen); }
  /// Marks the cell of a place, if it is visible, as confirmed by a measurement.
  void show(const Place& place) { mark(place, kSeen, kShown); }

  /// The share of the visible cells that are confirmed; 0 if none is visible.
  double share_shown() const {
    const auto shown = std::count(cells_.begin(), cells_.end(), kShown);
    const auto empty = std::count(cells_.begin(), cells_.end(), kNothing);
    const auto all = static_cast<std::int64_t>(cells_.size()) - empty;
    return all == 0 ? 0.0 : static_cast<double>(shown) / static_cast<double>(all);
  }

 private:
  std::int64_t along(double from_start) const {
    return static_cast<std::int64_t>(from_start / cell_);
  }

  void mark(const Place& place, Cell before, Cell after) {
    const std::int64_t layer = along(place[2] - low_[2]);
    const std::int64_t index =
        (layer * rows_ + along(place[1] - low_[1])) * columns_ + along(place[0] - low_[0]);
    if (index < 0 || index >= static_cast<std::int64_t>(cells_.size())) return;
    Cell& cell = cells_[to_index(index)];
    if (cell == before) cell = after;
  }

  bool at_rest_;                 ///< some faces turn away from others
  const Array<double>& places_;  ///< [V,2] px of the texture, or [V,3] m at rest
  Place low_{};
  double cell_ = 1.0;  ///< [px] or [m]
  std::int64_t columns_ = 1, rows_ = 1;
  std::vector<Cell>& cells_;
};

}  // namespace weft
