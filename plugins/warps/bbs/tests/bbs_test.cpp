// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <weft/data/matrix.hpp>
#include <weft/testing/atlas.hpp>

#include "common/tests/warp_bench.hpp"

namespace {

using weft::Array;
using weft::Correspondences;
using weft::Points2;
using weft::Rng;
using weft::testing::affine;
using weft::testing::diag;
using weft::testing::matches_at;
using weft::testing::PluginAnswer;
using weft::testing::PluginUnderTest;
using weft::testing::put_in_atlas;
using weft::testing::uniform_points;
using weft::testing::WarpBench;
using weft::testing::wavy;

struct Bench : WarpBench {
  explicit Bench(const std::string& params = "{}") : WarpBench("warps/bbs", params) {}
};

TEST(BbsWarp, ReproducesAffineMapsExactly) {
  Bench bench;
  Rng rng(1);
  const PluginAnswer outcome = bench.fit(matches_at(uniform_points(25, rng), affine));
  ASSERT_EQ(outcome.status, WEFT_OK) << outcome.message;
  const auto warp = *outcome.get<weft::Warp>();
  EXPECT_LT(bench.worst_error(warp, uniform_points(200, rng), affine), 1e-8);
  EXPECT_LT(diag(warp, "rms_residual_px"), 1e-8);
  EXPECT_NEAR(diag(warp, "min_det_jacobian"), 0.5 * 0.6 + 0.1 * 0.05, 1e-9);
  EXPECT_NEAR(diag(warp, "median_det_jacobian"), 0.5 * 0.6 + 0.1 * 0.05, 1e-9);
}

TEST(BbsWarp, FollowsASmoothMap) {
  Bench bench("{smoothing: dimensionless, lambda: 0.001}");
  Rng rng(2);
  const PluginAnswer outcome = bench.fit(matches_at(uniform_points(1000, rng), wavy));
  ASSERT_EQ(outcome.status, WEFT_OK) << outcome.message;
  EXPECT_LT(bench.worst_error(*outcome.get<weft::Warp>(), uniform_points(200, rng), wavy), 0.1);
}

TEST(BbsWarp, GivesDerivativesThatAgreeWithFiniteDifferences) {
  Bench bench;
  Rng rng(3);
  const auto warp = *bench.fit(matches_at(uniform_points(300, rng), wavy)).get<weft::Warp>();
  constexpr double kStep = 1e-3;
  const Points2 points = uniform_points(50, rng);
  const Eigen::RowVector2d along_u(kStep, 0.0), along_v(0.0, kStep);
  const auto here = bench.evaluate(warp, points, 2);
  const auto right = bench.evaluate(warp, points.rowwise() + along_u, 1);
  const auto left = bench.evaluate(warp, points.rowwise() - along_u, 1);
  const auto below = bench.evaluate(warp, points.rowwise() + along_v, 1);
  const auto above = bench.evaluate(warp, points.rowwise() - along_v, 1);
  const auto difference = [](double after, double before) {
    return (after - before) / (2 * kStep);
  };
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    for (Eigen::Index x = 0; x < 2; ++x) {
      const double* j = here.jacobian.row(i) + 2 * x;
      const double* h = here.hessian.row(i) + 3 * x;
      EXPECT_NEAR(j[0], difference(right.xy_px(i, x), left.xy_px(i, x)), 1e-6);
      EXPECT_NEAR(j[1], difference(below.xy_px(i, x), above.xy_px(i, x)), 1e-6);
      EXPECT_NEAR(h[0], difference(right.jacobian(i, 2 * x), left.jacobian(i, 2 * x)), 1e-6);
      EXPECT_NEAR(h[1], difference(below.jacobian(i, 2 * x), above.jacobian(i, 2 * x)), 1e-6);
      EXPECT_NEAR(h[2], difference(below.jacobian(i, 2 * x + 1), above.jacobian(i, 2 * x + 1)),
                  1e-6);
    }
  }
}

TEST(BbsWarp, GoesOnLinearlyOutsideItsDomainAndSaysSo) {
  Bench bench;
  Rng rng(4);
  const auto warp = *bench.fit(matches_at(uniform_points(300, rng), wavy)).get<weft::Warp>();
  EXPECT_EQ(warp.domain_px(0), -20.5);
  EXPECT_EQ(warp.domain_px(3), 594.5);
  Points2 points(5, 2);
  points << 979.5, 300, 1079.5, 300, 1179.5, 300, 500, 300, std::nan(""), 1;
  const auto samples = bench.evaluate(warp, points, 1);
  const auto xy = samples.xy_px.matrix<2>();
  EXPECT_LT((xy.row(2) - 2.0 * xy.row(1) + xy.row(0)).norm(), 1e-9);
  EXPECT_EQ(samples.valid(0), 1);
  EXPECT_EQ(samples.valid(2), 0);
  EXPECT_EQ(samples.valid(3), 1);
  EXPECT_EQ(samples.valid(4), 0);
}

TEST(BbsWarp, CoversTheObjectOfAnAtlasAlone) {
  Bench bench;
  Rng rng(6);
  auto matches = matches_at(uniform_points(300, rng), wavy);
  const auto alone = *bench.fit(matches).get<weft::Warp>();
  const Eigen::RowVector2d corner_px(1024.0, 512.0);
  matches.template_px.matrix<2>().rowwise() += corner_px;
  put_in_atlas(bench.templ, 4096, 2048, corner_px);
  const auto in_atlas = *bench.fit(matches).get<weft::Warp>();
  EXPECT_EQ(in_atlas.domain_px(0), 1024.0 - 20.5);
  EXPECT_EQ(in_atlas.domain_px(1), 1024.0 + 979.5);
  EXPECT_EQ(in_atlas.domain_px(2), 512.0 - 20.5);
  EXPECT_EQ(in_atlas.domain_px(3), 512.0 + 594.5);
  const Points2 places = uniform_points(40, rng);
  const auto there = bench.evaluate(in_atlas, places.rowwise() + corner_px, 0);
  const auto here = bench.evaluate(alone, places, 0);
  EXPECT_LT((there.xy_px.matrix<2>() - here.xy_px.matrix<2>()).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(BbsWarp, EvaluatesARecordWhateverWasFittedSince) {
  Bench bench;
  Rng rng(5);
  const Points2 places = uniform_points(40, rng);
  const auto first = *bench.fit(matches_at(uniform_points(300, rng), wavy)).get<weft::Warp>();
  const Points2 before = bench.at(first, places);
  ASSERT_EQ(bench.fit(matches_at(uniform_points(50, rng), affine)).status, WEFT_OK);
  EXPECT_EQ(bench.at(first, places), before);
}

TEST(BbsWarp, FitsOnlyMatchesThatAreKept) {
  Bench bench;
  Rng rng(6);
  Correspondences matches = matches_at(uniform_points(100, rng), affine);
  for (Eigen::Index i = 0; i < 40; ++i) {
    matches.image_px(i, 0) += 100.0;
    matches.kept(i) = 0;
  }
  const auto warp = *bench.fit(matches).get<weft::Warp>();
  EXPECT_LT(bench.worst_error(warp, uniform_points(50, rng), affine), 1e-8);
  EXPECT_EQ(diag(warp, "matches"), 60.0);
}

TEST(BbsWarp, CountsAMatchOfWeightTwoLikeTwoMatches) {
  Bench bench;
  Rng rng(7);
  Points2 points = uniform_points(80, rng);
  Points2 doubled(160, 2);
  doubled << points, points;
  Correspondences noisy = matches_at(points, wavy), noisy_doubled = matches_at(doubled, wavy);
  for (Eigen::Index i = 0; i < 80; ++i) {
    noisy.image_px(i, 0) += rng.normal();
    noisy_doubled.image_px(i, 0) = noisy_doubled.image_px(i + 80, 0) = noisy.image_px(i, 0);
  }
  const weft::Weights two{weft::make_array<double>(Eigen::VectorXd::Constant(80, 2.0))};
  const auto weighted = *bench.fit(noisy, two).get<weft::Warp>();
  const auto repeated = *bench.fit(noisy_doubled).get<weft::Warp>();
  const Points2 places = uniform_points(30, rng);
  EXPECT_LT((bench.at(weighted, places) - bench.at(repeated, places)).cwiseAbs().maxCoeff(), 1e-8);
}

class RobustBbsWarp : public ::testing::TestWithParam<const char*> {};

TEST_P(RobustBbsWarp, StaysWithinHalfAPixelAmongThirtyPercentGrossOutliers) {
  Bench bench(std::string("{robust: ") + GetParam() + "}"), plain;
  for (const std::uint64_t seed : {101U, 102U, 103U}) {
    SCOPED_TRACE(seed);
    Rng rng(seed);
    Correspondences matches = matches_at(uniform_points(600, rng), wavy);
    for (Eigen::Index i = 0; i < 180; ++i) {
      matches.image_px(i, 0) = rng.uniform(0.0, 640.0);
      matches.image_px(i, 1) = rng.uniform(0.0, 480.0);
    }
    Correspondences correct = matches;
    correct.kept = Array<std::uint8_t>({600}, 0);  // a copy of an array would share its memory
    std::fill_n(correct.kept.data() + 180, 420, std::uint8_t{1});
    const Points2 places = uniform_points(200, rng);
    const auto robust = *bench.fit(matches).get<weft::Warp>();
    const auto expected = plain.at(*plain.fit(correct).get<weft::Warp>(), places);
    EXPECT_LT((bench.at(robust, places) - expected).rowwise().norm().maxCoeff(), 0.5);
    EXPECT_LT(diag(robust, "mean_weight"), 0.75);
    const auto spoilt = plain.at(*plain.fit(matches).get<weft::Warp>(), places);
    EXPECT_GT((spoilt - expected).rowwise().norm().maxCoeff(), 5.0);
  }
}

INSTANTIATE_TEST_SUITE_P(Losses, RobustBbsWarp, ::testing::Values("tukey", "geman_mcclure"));

TEST(BbsWarp, HasNoResultWithoutMatches) {
  Bench bench;
  Rng rng(8);
  EXPECT_EQ(bench.fit(matches_at(Points2(0, 2), affine)).status, WEFT_NO_RESULT);
  const Correspondences matches = matches_at(uniform_points(20, rng), affine);
  const weft::Weights none{weft::make_array<double>(Eigen::VectorXd::Zero(20))};
  EXPECT_EQ(bench.fit(matches, none).status, WEFT_NO_RESULT);
}

TEST(BbsWarp, FlagsMatchesOnALineAsDegenerate) {
  Bench bench;
  Points2 line(30, 2);
  for (int i = 0; i < 30; ++i) line.row(i) << 20.0 + 30.0 * i, 100.0 + 10.0 * i;
  const PluginAnswer outcome = bench.fit(matches_at(line, affine));
  EXPECT_EQ(outcome.status, WEFT_DEGENERATE);
  EXPECT_LT(bench.worst_error(*outcome.get<weft::Warp>(), line, affine), 1e-6);
}

TEST(BbsWarp, GuessesASimilarityFromTwoMatchesAndATranslationFromOnePlace) {
  Bench bench;
  weft::testing::expect_guesses(bench);
}

TEST(BbsWarp, HasNoResultWhenNothingPenalisesWhatTheMatchesLeaveFree) {
  Bench bench("{lambda_px2: 0, ridge: 0}"), nearly("{lambda_px2: 1e-11, ridge: 0}");
  Rng rng(9);
  const Correspondences matches = matches_at(uniform_points(20, rng), affine);
  EXPECT_EQ(bench.fit(matches).status, WEFT_NO_RESULT);
  const PluginAnswer weak = nearly.fit(matches);
  EXPECT_EQ(weak.status, WEFT_DEGENERATE);
  EXPECT_EQ(weak.message, "the matches hardly determine the warp");
}

TEST(BbsWarp, DropsAndCountsMatchesOutsideItsDomain) {
  Bench bench;
  Rng rng(10);
  Points2 points = uniform_points(40, rng);
  points.row(3) << 1200.0, 100.0;
  points.row(4) << 100.0, -21.0;
  Correspondences matches = matches_at(points, affine);
  matches.image_px(3, 0) += 500.0;
  const auto warp = *bench.fit(matches).get<weft::Warp>();
  EXPECT_EQ(diag(warp, "dropped_outside"), 2.0);
  EXPECT_LT(bench.worst_error(warp, uniform_points(20, rng), affine), 1e-8);
}

TEST(BbsWarp, RefusesNumbersThatAreNotFinite) {
  Bench bench;
  Rng rng(11);
  Correspondences matches = matches_at(uniform_points(20, rng), affine);
  matches.image_px(5, 1) = std::nan("");
  const PluginAnswer outcome = bench.fit(matches);
  EXPECT_EQ(outcome.status, WEFT_ERROR);
  EXPECT_NE(outcome.message.find("match 5"), std::string::npos) << outcome.message;
  matches.kept(5) = 0;
  EXPECT_EQ(bench.fit(matches).status, WEFT_OK);
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(20);
  weights[2] = -1.0;
  EXPECT_EQ(bench.fit(matches, {weft::make_array<double>(weights)}).status, WEFT_ERROR);
}

TEST(BbsWarp, RefusesAModelThatIsNotItsOwnAndUnknownOrders) {
  Bench bench;
  Rng rng(12);
  auto warp = *bench.fit(matches_at(uniform_points(20, rng), affine)).get<weft::Warp>();
  const weft::Points points{weft::make_array<double>(uniform_points(3, rng)), 3};
  EXPECT_EQ(bench.plugin.evaluate(warp, points).status, WEFT_ERROR);
  warp.model.entries.pop_back();
  const weft::Points plain{points.xy_px, 0};
  EXPECT_EQ(bench.plugin.evaluate(warp, plain).status, WEFT_ERROR);
}

TEST(BbsWarp, RefusesTooFewControlPoints) {
  EXPECT_THROW(PluginUnderTest("warps/bbs", "{control_u: 3}"), std::runtime_error);
}

}  // namespace
