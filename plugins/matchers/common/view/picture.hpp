// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/pictures/picture.hpp"

namespace weft::view {

inline constexpr int kLanes = 4;
typedef float Lanes __attribute__((vector_size(kLanes * sizeof(float))));
typedef float LanesInMemory
    __attribute__((vector_size(kLanes * sizeof(float)), aligned(alignof(float)), may_alias));

typedef int WholeLanes __attribute__((vector_size(kLanes * sizeof(int))));

inline Lanes load_lanes(const float* from) { return *reinterpret_cast<const LanesInMemory*>(from); }
inline void store_lanes(Lanes lanes, float* to) { *reinterpret_cast<LanesInMemory*>(to) = lanes; }
inline float sum_of(Lanes lanes) { return (lanes[0] + lanes[2]) + (lanes[1] + lanes[3]); }

using pictures::at_level;
using pictures::halve;
using pictures::Picture;
using pictures::read_grey;
static_assert(pictures::kSpare >= kLanes);

inline constexpr int kLevels = 4;

/// An image with its halved copies, of any size.
class Pyramid {
 public:
  /// `pixels` [H,W] grey or [H,W,3] BGR, not empty.
  void load(const Array<std::uint8_t>& pixels) { all_.load(pixels, kLevels, 0); }
  const Picture& level(int k) const { return all_.level(k); }

 private:
  pictures::Pyramid all_;
};

}  // namespace weft::view
