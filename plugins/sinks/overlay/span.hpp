// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace weft::overlay {

/// A value that changes linearly along a row of pixels.
struct Ramp {
  float first = 0.0F, step = 0.0F;
};

/// The pixels of a triangle in one row of a raster, and its paint.
struct Span {
  std::size_t count = 0;
  Ramp nearness;                      ///< 1/m
  Ramp u, v, light, pallor;           ///< times `nearness`
  std::array<Ramp, 3> distance_px{};  ///< from each side that is a line

  const std::int32_t* texels = nullptr;  ///< blue in the lowest byte; the last column and row twice
  int texels_per_row = 0;
  float last_u = 0.0F, last_v = 0.0F;
  float reach_px = 0.0F;  ///< distance at which a line ends
  std::array<float, 3> blank{}, line{};
};

/// Pixels behind a span that fill() may write, without a change.
inline constexpr int kPixelsBehind = 8;

/// Colours the pixels whose `nearness` is smaller than that of the span.
void fill(const Span& span, float* nearness, std::int32_t* colour);

}  // namespace weft::overlay
