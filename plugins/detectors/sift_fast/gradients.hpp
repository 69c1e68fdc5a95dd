// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

namespace weft::sift_fast {

/// Angles are whole numbers, 2^16 of them in a turn, which begin again by themselves; clockwise
/// from +x.
constexpr double kTurn = 65536.0;

/// A window of a layer whose pixels all have neighbours.
struct Window {
  const std::int16_t* first = nullptr;  ///< its first pixel
  std::ptrdiff_t stride = 0;
  std::size_t width = 0, height = 0;
};

/// Elements of a row of gradients of a window.
constexpr std::size_t padded(std::size_t width) { return (width + 31) / 32 * 32; }

/// For each pixel of a window the length of its gradient, weighted by its column and row (columns
/// have weights up to padded(width)), and the nearest of `bins` directions. Bin 0 points to +x, and
/// the others follow clockwise. Rows of padded(width).
void weighted_gradients(const Window& window, const float* across, const float* down, int bins,
                        float* lengths, std::uint16_t* directions);

/// Lengths and angles of gradients, to 0.04 degrees. Arrays are read and written up to a multiple
/// of 32.
void to_polar(const std::int16_t* right, const std::int16_t* down, std::size_t count, float* length,
              std::uint16_t* angle);

}  // namespace weft::sift_fast
