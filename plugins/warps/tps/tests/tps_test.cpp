// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <weft/data/matrix.hpp>

#include "common/tests/warp_bench.hpp"

namespace {

using ::testing::HasSubstr;
using weft::Correspondences;
using weft::Points2;
using weft::Rng;
using weft::testing::affine;
using weft::testing::diag;
using weft::testing::matches_at;
using weft::testing::PluginAnswer;
using weft::testing::PluginUnderTest;
using weft::testing::uniform_points;
using weft::testing::WarpBench;
using weft::testing::wavy;

class TpsWarp : public ::testing::TestWithParam<const char*> {
 protected:
  static WarpBench bench(const std::string& more = "") {
    return {"warps/tps", std::string("{centres: ") + GetParam() + more + "}"};
  }
};

INSTANTIATE_TEST_SUITE_P(Centres, TpsWarp, ::testing::Values("grid", "matches"));

TEST_P(TpsWarp, ReproducesAffineMapsExactly) {
  WarpBench bench = TpsWarp::bench();
  Rng rng(1);
  const PluginAnswer outcome = bench.fit(matches_at(uniform_points(25, rng), affine));
  ASSERT_EQ(outcome.status, WEFT_OK) << outcome.message;
  const auto warp = *outcome.get<weft::Warp>();
  EXPECT_LT(bench.worst_error(warp, uniform_points(200, rng), affine), 1e-6);
  EXPECT_NEAR(diag(warp, "min_det_jacobian"), 0.5 * 0.6 + 0.1 * 0.05, 1e-7);
}

TEST_P(TpsWarp, FollowsASmoothMap) {
  WarpBench bench = TpsWarp::bench(", lambda: 1e-8");
  Rng rng(2);
  const PluginAnswer outcome = bench.fit(matches_at(uniform_points(600, rng), wavy));
  ASSERT_EQ(outcome.status, WEFT_OK) << outcome.message;
  EXPECT_LT(bench.worst_error(*outcome.get<weft::Warp>(), uniform_points(200, rng), wavy), 0.5);
}

TEST_P(TpsWarp, GivesDerivativesThatAgreeWithFiniteDifferences) {
  WarpBench bench = TpsWarp::bench();
  Rng rng(3);
  const auto warp = *bench.fit(matches_at(uniform_points(200, rng), wavy)).get<weft::Warp>();
  constexpr double kStep = 1e-3;
  const Points2 points = uniform_points(50, rng);
  const Eigen::RowVector2d along_u(kStep, 0.0), along_v(0.0, kStep);
  const auto here = bench.evaluate(warp, points, 2);
  const auto right = bench.evaluate(warp, points.rowwise() + along_u, 1);
  const auto left = bench.evaluate(warp, points.rowwise() - along_u, 1);
  const auto below = bench.evaluate(warp, points.rowwise() + along_v, 1);
  const auto above = bench.evaluate(warp, points.rowwise() - along_v, 1);
  const auto slope = [](double after, double before) { return (after - before) / (2 * kStep); };
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    for (Eigen::Index x = 0; x < 2; ++x) {
      const double* j = here.jacobian.row(i) + 2 * x;
      const double* h = here.hessian.row(i) + 3 * x;
      EXPECT_NEAR(j[0], slope(right.xy_px(i, x), left.xy_px(i, x)), 1e-6);
      EXPECT_NEAR(j[1], slope(below.xy_px(i, x), above.xy_px(i, x)), 1e-6);
      EXPECT_NEAR(h[0], slope(right.jacobian(i, 2 * x), left.jacobian(i, 2 * x)), 1e-6);
      EXPECT_NEAR(h[1], slope(below.jacobian(i, 2 * x), above.jacobian(i, 2 * x)), 1e-6);
      EXPECT_NEAR(h[2], slope(below.jacobian(i, 2 * x + 1), above.jacobian(i, 2 * x + 1)), 1e-6);
    }
  }
}

TEST_P(TpsWarp, FindsTheSmoothingThatNoiseAsksFor) {
  WarpBench searching = TpsWarp::bench(", smoothing: leave_one_out");
  WarpBench little = TpsWarp::bench(", lambda: 1e-8"), much = TpsWarp::bench(", lambda: 1");
  Rng rng(4);
  Correspondences matches = matches_at(uniform_points(150, rng), wavy);
  for (Eigen::Index i = 0; i < 150; ++i) {
    matches.image_px(i, 0) += 1.5 * rng.normal();
    matches.image_px(i, 1) += 1.5 * rng.normal();
  }
  const Points2 places = uniform_points(300, rng);
  const auto rms_px = [&](WarpBench& bench) {
    const auto warp = *bench.fit(matches).get<weft::Warp>();
    const Points2 values = bench.at(warp, places);
    double sum = 0.0;
    for (Eigen::Index i = 0; i < places.rows(); ++i) {
      sum += (values.row(i) - wavy(places(i, 0), places(i, 1))).squaredNorm();
    }
    return std::sqrt(sum / static_cast<double>(places.rows()));
  };
  const double found = rms_px(searching);
  EXPECT_LT(found, rms_px(little));
  EXPECT_LT(found, rms_px(much));
  EXPECT_LT(found, 1.0);
}

TEST_P(TpsWarp, HasNoResultWithoutMatchesAndAGuessForALine) {
  WarpBench bench = TpsWarp::bench();
  EXPECT_EQ(bench.fit(matches_at(Points2(0, 2), affine)).status, WEFT_NO_RESULT);
  Points2 line(30, 2);
  for (int i = 0; i < 30; ++i) line.row(i) << 20.0 + 30.0 * i, 100.0 + 10.0 * i;
  const PluginAnswer outcome = bench.fit(matches_at(line, affine));
  EXPECT_EQ(outcome.status, WEFT_DEGENERATE);
  EXPECT_LT(bench.worst_error(*outcome.get<weft::Warp>(), line, affine), 1e-6);
}

TEST_P(TpsWarp, GuessesASimilarityFromTwoMatchesAndATranslationFromOnePlace) {
  WarpBench bench = TpsWarp::bench();
  weft::testing::expect_guesses(bench);
}

TEST_P(TpsWarp, LeavesOutWhatIsNotKeptOutsideOrWithoutWeight) {
  WarpBench bench = TpsWarp::bench();
  Rng rng(6);
  Points2 points = uniform_points(60, rng);
  points.row(3) << 1200.0, 100.0;
  Correspondences matches = matches_at(points, affine);
  matches.image_px(3, 0) += 500.0;
  matches.image_px(4, 0) += 500.0;
  matches.kept(4) = 0;
  matches.image_px(5, 0) += 500.0;
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(60);
  weights[5] = 0.0;
  const auto warp = *bench.fit(matches, {weft::make_array<double>(weights)}).get<weft::Warp>();
  EXPECT_EQ(diag(warp, "matches"), 57.0);
  EXPECT_EQ(diag(warp, "dropped_outside"), 1.0);
  EXPECT_LT(bench.worst_error(warp, uniform_points(50, rng), affine), 1e-6);
}

TEST_P(TpsWarp, GoesOnOutsideItsDomainAndSaysSo) {
  WarpBench bench = TpsWarp::bench();
  Rng rng(7);
  const auto warp = *bench.fit(matches_at(uniform_points(100, rng), wavy)).get<weft::Warp>();
  Points2 points(3, 2);
  points << 979.0, 300.0, 1079.5, 300.0, std::nan(""), 1.0;
  const auto samples = bench.evaluate(warp, points, 1);
  EXPECT_EQ(samples.valid(0), 1);
  EXPECT_EQ(samples.valid(1), 0);
  EXPECT_EQ(samples.valid(2), 0);
}

TEST(TpsWarpAlone, UsesTheGridWhereMatchesAreTooMany) {
  WarpBench bench("warps/tps", "{centres: matches, most_matches: 50, grid_u: 6, grid_v: 5}");
  Rng rng(8);
  const auto few = *bench.fit(matches_at(uniform_points(50, rng), wavy)).get<weft::Warp>();
  const auto many = *bench.fit(matches_at(uniform_points(51, rng), wavy)).get<weft::Warp>();
  EXPECT_EQ(diag(few, "centres"), 50.0);
  EXPECT_EQ(diag(many, "centres"), 30.0);
}

TEST(TpsWarpAlone, RefusesAModelThatIsNotItsOwn) {
  WarpBench bench("warps/tps", "{}"), bbs("warps/bbs", "{}");
  Rng rng(9);
  const Correspondences matches = matches_at(uniform_points(40, rng), affine);
  auto foreign = *bbs.fit(matches).get<weft::Warp>();
  const PluginAnswer outcome =
      bench.plugin.evaluate(foreign, {weft::make_array<double>(uniform_points(3, rng)), 0});
  EXPECT_EQ(outcome.status, WEFT_ERROR);
  EXPECT_THAT(outcome.message, HasSubstr("'warps/bbs'"));
}

}  // namespace
