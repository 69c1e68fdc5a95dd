// SPDX-License-Identifier: Apache-2.0
#include "confidence.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace weft::brunet_refine {
namespace {

TEST(Confidence, FallsWithEachSignOfTrouble) {
  const double best = confidence({0.001, 0.5, 1.0});
  EXPECT_GT(best, 0.9);
  EXPECT_GT(best, confidence({0.02, 0.5, 1.0}));
  EXPECT_GT(best, confidence({0.001, 3.0, 1.0}));
  EXPECT_GT(best, confidence({0.001, 0.5, 0.2}));
}

TEST(Confidence, IsSmallWhereLengthsOrMatchesAreFarOff) {
  EXPECT_LT(confidence({0.05, 0.5, 1.0}), 0.2);
  EXPECT_LT(confidence({0.001, 20.0, 0.0}), 0.2);
  EXPECT_EQ(confidence({0.001, std::numeric_limits<double>::infinity(), 1.0}), 0.0);
}

}  // namespace
}  // namespace weft::brunet_refine
