// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <iterator>
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

}  // namespace weft
