// SPDX-License-Identifier: Apache-2.0
// Tracks a surface for 10,000 frames. It is detected only where tracking is in doubt.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "tracked_pipeline.hpp"

namespace weft {
namespace {

class LongTracks : public testing::TrackedPipeline {
 protected:
#if defined(WEFT_SANITIZED)
  void SetUp() override { GTEST_SKIP() << "ten thousand frames in release alone"; }
#endif
};

TEST_F(LongTracks, DoNotDrift) {
  constexpr std::int64_t kFrames = 10'000;
  const std::string source = "source: {params: {frames: " + std::to_string(kFrames) +
                             ", image_width_px: 320, image_height_px: 240, focal_px: 410, "
                             "distance_m: 0.5}}\n";
  const auto metrics = measure("tracked.yaml", source +
                                                   "stages:\n"
                                                   "  - {as: tracked}\n"
                                                   "  - {as: detectors, when: {every: 1000000}}\n");
  EXPECT_EQ(metrics.counts.solved(), kFrames);
  EXPECT_LT(metrics.all.solved_error.mean_mm, 0.75);
  EXPECT_LT(metrics.all.solved_error.worst_mm, 0.02 * 364.0);  // 2 % of the diagonal: not wrong
  EXPECT_LT(detected(), kFrames / 10);
}

}  // namespace
}  // namespace weft
