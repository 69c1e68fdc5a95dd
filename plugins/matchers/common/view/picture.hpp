// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/data/array.hpp>

namespace weft::view {

inline constexpr int kLanes = 4;
typedef float Lanes __attribute__((vector_size(kLanes * sizeof(float))));
typedef float LanesInMemory
    __attribute__((vector_size(kLanes * sizeof(float)), aligned(alignof(float)), may_alias));

typedef int WholeLanes __attribute__((vector_size(kLanes * sizeof(int))));

inline Lanes load_lanes(const float* from) { return *reinterpret_cast<const LanesInMemory*>(from); }
inline void store_lanes(Lanes lanes, float* to) { *reinterpret_cast<LanesInMemory*>(to) = lanes; }
inline float sum_of(Lanes lanes) { return (lanes[0] + lanes[2]) + (lanes[1] + lanes[3]); }

/// Grey levels row by row.
struct Picture {
  int width = 0;                ///< [] px
  int height = 0;               ///< [] px
  std::vector<float> values{};  ///< [height * width], and kLanes more that may be read

  void resize(int new_width, int new_height);
  const float* row(int y) const { return values.data() + to_index(y) * to_index(width); }
  float* row(int y) { return values.data() + to_index(y) * to_index(width); }
};

/// Halved copies: pixel x of level k is centred at 2^k (x + 1/2) - 1/2 of the picture itself.
inline constexpr int kLevels = 4;

inline double at_level(double place_px, int level) {
  return (place_px + 0.5) / static_cast<double>(1 << level) - 0.5;
}

/// `from` at half its size, each pixel the mean of four; what is left over at the border is lost.
void halve(const Picture& from, Picture& to);

/// An image with its halved copies.
class Pyramid {
 public:
  /// `pixels` [H,W] grey or [H,W,3] BGR, not empty.
  void load(const Array<std::uint8_t>& pixels);
  const Picture& level(int k) const { return levels_[to_index(k)]; }

 private:
  std::array<Picture, kLevels> levels_;
};

/// One channel of `pixels`, in `grey`.
void read_grey(const Array<std::uint8_t>& pixels, Picture& grey);

}  // namespace weft::view
