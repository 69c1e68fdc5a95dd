// SPDX-License-Identifier: Apache-2.0
#include "pipeline/monitor/rejected_matches.hpp"

#include <gtest/gtest.h>

#include <iostream>
#include <weft/core/rng.hpp>

namespace weft {
namespace {

class CoherentRejectsTest : public ::testing::Test {
 protected:
  static constexpr std::uint64_t kSeed = 2032;

  CoherentRejectsTest() { std::cout << "seed " << kSeed << "\n"; }

  /// Matches all over a texture of 800 x 600, seen where they are; the first `kept` are kept.
  Correspondences seen(std::int64_t count, std::int64_t kept) {
    Correspondences matches;
    matches.template_px = Array<double>({count, 2}, 0.0);
    matches.image_px = Array<double>({count, 2}, 0.0);
    matches.kept = Array<std::uint8_t>({count}, 0);
    for (std::int64_t i = 0; i < count; ++i) {
      matches.template_px(i, 0) = 800.0 * rng_.uniform();
      matches.template_px(i, 1) = 600.0 * rng_.uniform();
      for (int k = 0; k < 2; ++k) matches.image_px(i, k) = matches.template_px(i, k);
      matches.kept(i) = i < kept ? 1 : 0;
    }
    return matches;
  }

  Rng rng_{kSeed};
};

TEST_F(CoherentRejectsTest, AreHardlyAnyAmongMismatches) {
  Correspondences matches = seen(400, 200);
  for (std::int64_t i = 200; i < 400; ++i) {
    matches.image_px(i, 0) = 800.0 * rng_.uniform();
    matches.image_px(i, 1) = 600.0 * rng_.uniform();
  }
  EXPECT_LE(RejectedMatches().look(matches).count, 6);
}

TEST_F(CoherentRejectsTest, AreTheSecondPrintInView) {
  Correspondences matches = seen(400, 200);
  for (std::int64_t i = 200; i < 400; ++i) matches.image_px(i, 0) += 1000.0;
  const CoherentRejects found = RejectedMatches().look(matches);
  EXPECT_GT(found.count, 190);
  EXPECT_LT(found.elsewhere, 20);
}

TEST_F(CoherentRejectsTest, AreTheHalfOfThePrintThatLiesElsewhere) {
  Correspondences matches = seen(400, 0);
  for (std::int64_t i = 0; i < 400; ++i) {
    const bool left = matches.template_px(i, 0) < 400.0;
    matches.kept(i) = left ? 1 : 0;
    matches.image_px(i, 0) += left ? 400.0 : -400.0;
  }
  const CoherentRejects found = RejectedMatches().look(matches);
  EXPECT_GT(found.count, 180);
  EXPECT_GT(found.elsewhere, 0.7 * found.count);
}

TEST_F(CoherentRejectsTest, AreCountedAlsoAmongThousands) {
  Correspondences matches = seen(9000, 1000);
  for (std::int64_t i = 1000; i < 9000; ++i) matches.image_px(i, 0) += 1000.0;
  EXPECT_NEAR(RejectedMatches().look(matches).count, 8000, 100);
}

TEST_F(CoherentRejectsTest, AreNoneWhereNothingOrEverythingIsKept) {
  EXPECT_EQ(RejectedMatches().look(seen(100, 100)).count, 0);
  EXPECT_EQ(RejectedMatches().look(seen(100, 0)).count, 0);
  EXPECT_EQ(RejectedMatches().look(seen(0, 0)).count, 0);
}

/// A corner of the image with many orientations is one place, not many that agree.
TEST_F(CoherentRejectsTest, DoNotCountOneKeypointManyTimes) {
  Correspondences matches = seen(240, 200);
  for (std::int64_t i = 200; i < 240; ++i) {
    for (int k = 0; k < 2; ++k) {
      matches.template_px(i, k) = 10.0 + 0.001 * static_cast<double>(i);
      matches.image_px(i, k) = 500.0 + 0.001 * static_cast<double>(i);
    }
  }
  EXPECT_EQ(RejectedMatches().look(matches).count, 0);
}

}  // namespace
}  // namespace weft
