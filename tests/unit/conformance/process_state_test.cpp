// SPDX-License-Identifier: Apache-2.0
#include "conformance/probes/process_state.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace weft::conformance {
namespace {

constexpr std::size_t kBlock_bytes = std::size_t{1} << 20;

/// Each page of it is written to, so that it is in memory.
std::vector<char> block() { return std::vector<char>(kBlock_bytes, 'x'); }

TEST(ProcessState, DoesNotGrowByWhatIsFreed) {
  char last = block().back();
  const auto resident_before = resident_bytes(), heap_before = heap_bytes();
  for (int i = 0; i < 64; ++i) last = block().back();
  EXPECT_EQ(last, 'x');
  EXPECT_LT(resident_bytes() - resident_before, std::int64_t{kBlock_bytes});
  EXPECT_LT(heap_bytes() - heap_before, 1000);
}

TEST(ProcessState, GrowsByWhatIsKept) {
  std::vector<std::vector<char>> kept;
  const auto resident_before = resident_bytes(), heap_before = heap_bytes();
  for (int i = 0; i < 64; ++i) kept.push_back(block());
  EXPECT_GE(resident_bytes() - resident_before, std::int64_t{63 * kBlock_bytes});
  EXPECT_GE(heap_bytes() - heap_before, std::int64_t{64 * kBlock_bytes});
}

}  // namespace
}  // namespace weft::conformance
