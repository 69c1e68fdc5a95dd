// SPDX-License-Identifier: Apache-2.0
#include "annealing.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <weft/core/rng.hpp>

#include "isolated.hpp"

namespace weft::aem {
namespace {

/// Matches of a texture of 960 x 575 px that is seen at half of its size: the first `correct` are
/// where they belong, the others anywhere.
Matches seen_at_half_size(int correct, int wrong, Rng& rng) {
  Matches matches;
  matches.box = {-0.5, 959.5, -0.5, 574.5};
  matches.image_area_px2 = 640.0 * 480.0;
  matches.template_px.resize(correct + wrong, 2);
  matches.image_px.resize(correct + wrong, 2);
  for (int i = 0; i < correct + wrong; ++i) {
    matches.template_px.row(i) << rng.uniform(0.0, 960.0), rng.uniform(0.0, 575.0);
    matches.image_px.row(i) << rng.uniform(0.0, 640.0), rng.uniform(0.0, 480.0);
    if (i < correct) matches.image_px.row(i) = 0.5 * matches.template_px.row(i);
  }
  return matches;
}

Seed half_size() {
  Seed seed;
  seed.map.slope = 0.5 * Eigen::Matrix2d::Identity();
  seed.threshold_px = 0.08 * 0.5 * std::hypot(960.0, 575.0);
  return seed;
}

/// All matches go to one place, from whichever part of the texture.
TEST(Annealing, DoesNotTakeAClusterForASheet) {
  Rng rng(32);
  Matches matches = seen_at_half_size(0, 600, rng);
  for (int i = 0; i < 300; ++i) {
    matches.image_px.row(i) << 320.0 + 3.0 * rng.normal(), 240.0 + 3.0 * rng.normal();
  }
  Seed seed;
  seed.map.slope = 0.08 * Eigen::Matrix2d::Identity();
  seed.map.offset_px << 320.0 - 0.08 * 480.0, 240.0 - 0.08 * 287.0;
  seed.threshold_px = 0.08 * 0.08 * std::hypot(960.0, 575.0);
  Annealing annealing(matches, {});
  EXPECT_EQ(annealing.run(start_from(matches, seed)).log_likelihood, 0.0);
  const Matches sheet = seen_at_half_size(300, 300, rng);
  Annealing of_sheet(sheet, {});
  EXPECT_GT(of_sheet.run(start_from(sheet, half_size())).log_likelihood, 1000.0);
}

/// Inliers on the left half; the right is hidden, and one match of it goes to a copy.
TEST(Isolated, IsAMatchToACopyWhereTheSheetIsHidden) {
  constexpr int kMatches = 800, kOnCopy = 3;
  Rng rng(33);
  Matches matches = seen_at_half_size(kMatches, 0, rng);
  matches.template_px.row(kOnCopy) << 840.0, 290.0;
  Eigen::ArrayXd logit(kMatches);
  int visible = 0;
  for (int i = 0; i < kMatches; ++i) {
    const bool seen = matches.template_px(i, 0) < 480.0;
    visible += seen ? 1 : 0;
    logit[i] = seen || i == kOnCopy ? 6.0 : -12.0;
  }
  const Isolated isolated = find_isolated(matches, logit, visible / static_cast<double>(kMatches));
  for (int i = 0; i < kMatches; ++i) EXPECT_EQ(isolated.is[i], i == kOnCopy) << i;
  EXPECT_LT(isolated.shift[kOnCopy], -2.0);
  EXPECT_EQ((isolated.shift != 0.0).count(), 1);
}

/// With few matches none is missed by another.
TEST(Isolated, IsNoneWhereFewAreExpected) {
  Rng rng(34);
  const Matches matches = seen_at_half_size(30, 0, rng);
  Eigen::ArrayXd logit = Eigen::ArrayXd::Constant(30, -12.0);
  logit[3] = 6.0;
  EXPECT_FALSE(find_isolated(matches, logit, 0.5).is.any());
}

/// The same match with and without matches around: it bends the warp where nothing else is.
TEST(Isolated, MatchesDoNotInfluenceTheWarp) {
  constexpr int kMatches = 800, kOnCopy = 3;
  Rng rng(35);
  Matches matches = seen_at_half_size(kMatches, 0, rng);
  matches.template_px.row(kOnCopy) << 930.0, 560.0;
  for (int i = 0; i < kMatches; ++i) {
    matches.image_px.row(i) = 0.5 * matches.template_px.row(i);
    if (matches.template_px(i, 0) < 480.0 || i == kOnCopy) continue;
    matches.image_px.row(i) << rng.uniform(0.0, 640.0), rng.uniform(0.0, 480.0);
  }
  matches.image_px.row(kOnCopy) << 465.0 + 25.0, 280.0 + 25.0;
  const Start start = start_from(matches, half_size());
  Annealing annealing(matches, {});
  Solution solution = annealing.run(start);
  annealing.finish(start, solution);
  EXPECT_LT(solution.logit[kOnCopy], 0.0);
}

}  // namespace
}  // namespace weft::aem
