// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

namespace weft::matchers {

/// Trains of a panel, whose words of 64 bits lie side by side.
inline constexpr int kPanelWords = 8;

/// Inner loops on rows of bits, for one kind of processor. All give the same numbers.
struct BitKernel {
  const char* name;

  /// Numbers of differing bits, shifted down by `shift`, into [kBlockQueries, row_length]: of
  /// queries [kBlockQueries, words] and panels [row_length / kPanelWords, words, kPanelWords].
  void (*fill)(const std::uint64_t* queries, const std::uint64_t* panels, int row_length, int words,
               int shift, std::int16_t* codes);

  /// The number of differing bits of two rows.
  int (*differing)(const std::uint64_t* a, const std::uint64_t* b, int words);
};

/// Those that this processor can run, the fastest first. The last one runs everywhere.
const std::vector<BitKernel>& bit_kernels();

}  // namespace weft::matchers
