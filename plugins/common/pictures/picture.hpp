// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/data/array.hpp>

namespace weft::pictures {

inline constexpr int kSpare = 4;

/// Grey levels row by row; pixel centres at integers.
struct Picture {
  int width = 0;                ///< [] px
  int height = 0;               ///< [] px
  std::vector<float> values{};  ///< [height * width] 0 to 255, and kSpare more that may be read

  void resize(int new_width, int new_height);
  const float* row(int y) const { return values.data() + to_index(y) * to_index(width); }
  float* row(int y) { return values.data() + to_index(y) * to_index(width); }

  /// True if a place has four pixels around it.
  bool holds(float x, float y) const {
    return x >= 0.0F && y >= 0.0F && x < static_cast<float>(width - 1) &&
           y < static_cast<float>(height - 1);
  }

  /// Bilinear, at a place that it holds.
  float at(float x, float y) const {
    const int i = static_cast<int>(x), j = static_cast<int>(y);
    const float s = x - static_cast<float>(i), t = y - static_cast<float>(j);
    const float* above = row(j) + i;
    const float* below = above + width;
    const float upper = above[0] + s * (above[1] - above[0]);
    const float lower = below[0] + s * (below[1] - below[0]);
    return upper + t * (lower - upper);
  }
};

/// Converts a place in px of the full image to px of its copy that is halved `level` times.
inline double at_level(double place_px, int level) {
  return (place_px + 0.5) / static_cast<double>(1 << level) - 0.5;
}

/// The grey levels of `pixels`, [H,W] or [H,W,3] BGR.
void read_grey(const Array<std::uint8_t>& pixels, Picture& grey);

/// `from` at half its size: each pixel is the mean of four; an odd row or column is dropped.
void halve(const Picture& from, Picture& to);

/// An image with copies that are each half the size of the previous one.
class Pyramid {
 public:
  /// `pixels` [H,W] grey or [H,W,3] BGR, not empty; up to `most` levels, of `smallest_px` and more
  /// along each side.
  void load(const Array<std::uint8_t>& pixels, int most, int smallest_px = 8);

  int levels() const { return levels_; }
  const Picture& level(int k) const { return pictures_[to_index(k)]; }

 private:
  int levels_ = 0;
  std::vector<Picture> pictures_;  ///< the memory of those that are not used stays
};

}  // namespace weft::pictures
