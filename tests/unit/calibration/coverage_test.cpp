// SPDX-License-Identifier: Apache-2.0
#include "lab/calibration/coverage.hpp"

#include <gmock/gmock.h>

#include "board_views.hpp"

namespace weft::calibration {
namespace {

using testing::board_pose;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

class CoverageOf : public ::testing::Test {
 protected:
  View view(const Eigen::Vector2d& place, const Eigen::Vector2d& tilt_rad, double roll_rad = 0.0,
            double distance_m = 0.6) {
    return view_at(lens_, board_pose(lens_, middle_m(), place, distance_m, tilt_rad, roll_rad), 0.0,
                   rng_);
  }
  const testing::Lens lens_ = usual_lens();
  const ImageSize size_ = size_of(lens_);
  Rng rng_{1};
};

TEST_F(CoverageOf, NothingMissesNinePartsAndFourTurns) {
  EXPECT_EQ(coverage_of({}, size_).missing().size(), 13U);
  EXPECT_EQ(coverage_of({}, size_).share(), 0.0);
}

TEST_F(CoverageOf, OneCornerOfTheImageNamesTheOthers) {
  const auto missing = coverage_of({view({0.85, 0.15}, {0.0, 0.0}, 0.0, 1.2)}, size_).missing();
  EXPECT_THAT(missing, Not(Contains(HasSubstr("top right"))));
  for (const char* part : {"top left", "bottom left", "bottom right", "middle of the image"}) {
    EXPECT_THAT(missing, Contains(HasSubstr(part)));
  }
}

TEST_F(CoverageOf, TiltsAreClassifiedByTheFartherSideInAnyOrientationOfTheBoard) {
  const std::pair<Eigen::Vector2d, Turn> cases[] = {{{0.5, 0.0}, Turn::right},
                                                    {{-0.5, 0.0}, Turn::left},
                                                    {{0.0, 0.5}, Turn::lower},
                                                    {{0.0, -0.5}, Turn::upper}};
  for (const auto& [tilt_rad, turn] : cases) {
    for (const double roll_rad : {0.0, 0.7, 2.0, 3.1}) {
      const Placement placement = placement_of(view({0.4, 0.55}, tilt_rad, roll_rad), size_);
      EXPECT_LT((placement.tilt_rad - tilt_rad).norm(), 0.12) << roll_rad;
      const Coverage coverage = coverage_of({view({0.4, 0.55}, tilt_rad, roll_rad)}, size_);
      for (const Turn other : kTurns) {
        EXPECT_EQ(coverage.turned[static_cast<std::size_t>(other)], other == turn ? 1 : 0);
      }
    }
  }
}

TEST_F(CoverageOf, ABoardInTheWholeImageIsSeenInAllParts) {
  const Coverage coverage = coverage_of({view({0.5, 0.5}, {0.0, 0.0}, 0.0, 0.16)}, size_);
  EXPECT_GT(coverage.share(), 0.6);
  EXPECT_THAT(coverage.missing(), Not(Contains(HasSubstr("no corner yet"))));
}

}  // namespace
}  // namespace weft::calibration
