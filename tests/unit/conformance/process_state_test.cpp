// SPDX-License-Identifier: Apache-2.0
#include "kit/conformance/probes/process_state.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace weft::conformance {
namespace {

constexpr std::int64_t kBlock_bytes = std::int64_t{1} << 20;
constexpr int kBlocks = 64;

/// Each page of it is written to, so that it is in memory.
std::vector<char> block() { return std::vector<char>(kBlock_bytes, 'x'); }

// The C library keeps a block or two, and what reading a file needs is made with the first.
TEST(ProcessState, DoesNotGrowByWhatIsFreed) {
  const auto resident_before = resident_bytes(), heap_before = heap_bytes();
  char last = 0;
  for (int i = 0; i < kBlocks; ++i) last = block().back();
  EXPECT_EQ(last, 'x');
  EXPECT_LT(resident_bytes() - resident_before, kBlocks / 4 * kBlock_bytes);
  EXPECT_LT(heap_bytes() - heap_before, kBlock_bytes);
}

TEST(ProcessState, GrowsByWhatIsKept) {
  std::vector<std::vector<char>> kept;
  const auto resident_before = resident_bytes(), heap_before = heap_bytes();
  for (int i = 0; i < kBlocks; ++i) kept.push_back(block());
  EXPECT_GE(resident_bytes() - resident_before, (kBlocks - 4) * kBlock_bytes);
  EXPECT_GE(heap_bytes() - heap_before, kBlocks * kBlock_bytes);
}

}  // namespace
}  // namespace weft::conformance
