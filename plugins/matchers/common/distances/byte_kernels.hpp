// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

namespace weft::matchers {

/// Trains of a panel, whose bytes lie side by side in groups of kGroupBytes.
inline constexpr int kPanelTrains = 16;
inline constexpr int kGroupBytes = 4;
/// Rows of bytes have a multiple of this length.
inline constexpr int kRowBytes = 32;
/// Bytes are at most this, and the squares of a row sum up to at most kLargestNorm, so that sums of
/// products fit into 16 bits.
inline constexpr int kLargestByte = 127;
inline constexpr int kLargestNorm = 255 * 255;

/// Inner loops on rows of bytes a, b, for one kind of processor. The code of two rows is (h(a) +
/// h(b) - a.b) / 2 rounded down, at most 32767. Here h(a) = |a|^2 / 2 rounded up, so that 4 c - 2
/// <= |a - b|^2 <= 4 c + 2. All kinds give the same codes.
struct ByteKernels {
  const char* name;

  /// Codes [kBlockQueries, row_length] of queries [row_bytes / kGroupBytes, kBlockQueries], four
  /// bytes each, and panels [row_length / kPanelTrains, row_bytes / kGroupBytes, kPanelTrains,
  /// kGroupBytes].
  void (*fill)(const std::uint32_t* queries, const std::int32_t* query_halves,
               const std::uint8_t* panels, const std::int32_t* train_halves, int row_length,
               int row_bytes, std::int16_t* codes);

  /// Codes [count] of one query and the rows trains[chosen[i]] of [T, row_bytes].
  void (*fill_some)(const std::uint8_t* query, std::int32_t query_half, const std::uint8_t* trains,
                    const std::int32_t* train_halves, const int* chosen, int count, int row_bytes,
                    std::int16_t* codes);
};

/// Those that this processor can run, the fastest first. The last one runs everywhere.
const std::vector<ByteKernels>& byte_kernels();

}  // namespace weft::matchers
