// SPDX-License-Identifier: Apache-2.0
#include "pipeline/runs/warning_log.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/execution/frame_result.hpp"

namespace weft {
namespace {

constexpr int kWarning = 2;
constexpr std::size_t kListed = 100;

TEST(WarningLog, ListsTheFirstDifferentTextsOfAFrameAndCountsTheOthersOfEachComponent) {
  WarningLog log;
  for (int i = 0; i < 10'000; ++i) log.note("filters", kWarning, "number " + std::to_string(i), 0);
  for (int i = 0; i < 30; ++i) log.note("warps", kWarning, "other " + std::to_string(i), 0);
  log.file(0);
  log.file(1);
  const std::vector<RunWarning> warnings = log.take();
  ASSERT_EQ(warnings.size(), kListed + 2);
  EXPECT_EQ(warnings[0].text, "number 0");
  EXPECT_EQ(warnings[kListed].component, "filters");
  EXPECT_THAT(warnings[kListed].text, ::testing::StartsWith("and 9900 more warnings"));
  EXPECT_EQ(warnings[kListed].frames, 1);
  EXPECT_EQ(warnings[kListed + 1].component, "warps");
  EXPECT_THAT(warnings[kListed + 1].text, ::testing::StartsWith("and 30 more warnings"));
}

TEST(WarningLog, CountsAcrossFramesWhatIsBeyondTheFirstTextsOfARun) {
  WarningLog log;
  for (std::uint64_t frame = 0; frame < 150; ++frame) {
    log.note("filters", kWarning, "of frame " + std::to_string(frame), frame);
    log.note("filters", kWarning, "always", frame);
    log.file(frame);
  }
  const std::vector<RunWarning> warnings = log.take();
  ASSERT_EQ(warnings.size(), kListed + 1);
  EXPECT_EQ(warnings[1].text, "always");
  EXPECT_EQ(warnings[1].frames, 150);
  EXPECT_THAT(warnings.back().text, ::testing::StartsWith("and 51 more warnings"));
  EXPECT_EQ(warnings.back().frames, 51);
  EXPECT_TRUE(log.take().empty());
}

TEST(WarningLog, CountsATextBeforeTheFirstFrameOnce) {
  WarningLog log;
  for (int i = 0; i < 3; ++i) log.note("filters", kWarning, "no device", host::kOfflineFrame);
  const std::vector<RunWarning> warnings = log.take();
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_EQ(warnings[0].frames, 0);
}

}  // namespace
}  // namespace weft
