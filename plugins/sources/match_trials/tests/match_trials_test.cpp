// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>
#include <weft/data/matrix.hpp>
#include <weft/testing/plugin_under_test.hpp>
#include <weft/testing/synthetic.hpp>
#include <weft/truth/match_labels.hpp>

namespace weft::testing {
namespace {

constexpr int kOpen = 0, kCount = 1, kRead = 2;

/// The source, opened.
class Trials {
 public:
  explicit Trials(const std::string& params = "{}", std::uint64_t run_seed = 1)
      : plugin_("sources/match_trials", params, run_seed) {
    const PluginAnswer opened = plugin_.process(kOpen, {});
    if (opened.status != WEFT_OK) throw std::runtime_error(opened.message);
    camera = *opened.get<Camera>();
  }
  PluginAnswer read(std::uint64_t trial) { return plugin_.process(kRead, {}, trial); }
  std::int64_t count() { return plugin_.process(kCount, {}).get<Count>()->frames; }

  Camera camera;

 private:
  PluginUnderTest plugin_;
};

struct Trial {
  Correspondences matches;
  GroundTruth truth;
};

Trial trial_of(const PluginAnswer& outcome) {
  if (outcome.status != WEFT_OK) throw std::runtime_error(outcome.message);
  return {*outcome.get<Correspondences>(), *outcome.get<GroundTruth>()};
}

TEST(MatchTrials, GiveCameraAndCountAndNoImage) {
  Trials trials("{trials: 7, image_width_px: 320, image_height_px: 240, focal_px: 410}");
  EXPECT_EQ(trials.camera.fx, 410.0);
  EXPECT_EQ(trials.camera.cx, 159.5);
  EXPECT_EQ(trials.camera.height_px, 240);
  EXPECT_EQ(trials.count(), 7);
  EXPECT_FALSE(trials.read(3).get<Image>().has_value());
}

TEST(MatchTrials, LieOnTheTemplateOfTheirSizeAndOnTheTrueSurface) {
  Trials trials("{matches: 150}");
  const Template templ = make_template();
  const auto [matches, truth] = trial_of(trials.read(4));
  const Pinhole camera = pinhole(trials.camera);
  ASSERT_EQ(matches.count(), 150);
  ASSERT_TRUE(truth.faces.matrix<3>() == templ.faces.matrix<3>());
  ASSERT_TRUE(
      truth.template_xy_m.matrix<2>().isApprox(templ.vertices_m.matrix<3>().leftCols<2>(), 1e-12));
  for (std::int64_t n = 0; n < matches.count(); ++n) {
    const Eigen::Vector3d weights = matches.barycentrics.matrix<3>().row(n);
    const Eigen::Vector2d flat = interpolate(Points2(templ.flat_px.matrix<2>()),
                                             templ.faces.matrix<3>(), matches.face(n), weights);
    EXPECT_LT((flat - matches.template_px.matrix<2>().row(n).transpose()).norm(), 1e-9);
    const Eigen::Vector3d point_m = interpolate(Points3(truth.points_m.matrix<3>()),
                                                templ.faces.matrix<3>(), matches.face(n), weights);
    const Eigen::Vector2d true_px = truth.match_xy_px.matrix<2>().row(n);
    EXPECT_LT((project(camera, point_m) - true_px).norm(), 1e-9);
    EXPECT_TRUE(true_px.transpose() == matches.image_px.matrix<2>().row(n)) << "all are correct";
  }
}

TEST(MatchTrials, ReplaceTheGivenPartOfTheMatches) {
  constexpr int kMatches = 400;
  Trials trials("{matches: 400, inlier_rate: 0.3, seed: 5}");
  for (std::uint64_t trial = 0; trial < 3; ++trial) {
    const auto [matches, truth] = trial_of(trials.read(trial));
    int moved = 0;
    for (std::int64_t n = 0; n < kMatches; ++n) {
      const Eigen::RowVector2d q = matches.image_px.matrix<2>().row(n);
      moved += q != truth.match_xy_px.matrix<2>().row(n);
      EXPECT_TRUE(trials.camera.shows(q.x(), q.y()));
    }
    EXPECT_EQ(moved, 280);
    const auto labels = label_matches(matches, *TruthMap::create(truth), make_template(),
                                      pinhole(trials.camera), 2.0);
    const auto correct = std::count(labels.begin(), labels.end(), kCorrectMatch);
    EXPECT_GE(correct, 120);
    EXPECT_LE(correct, 125) << "a few mismatches lie near their true image by chance, seed 5";
  }
}

TEST(MatchTrials, DisplaceCorrectMatchesByTheirNoise) {
  Trials trials("{matches: 2000, noise_px: 0.5, seed: 6}");
  const auto [matches, truth] = trial_of(trials.read(0));
  const Points2 noise_px = matches.image_px.matrix<2>() - truth.match_xy_px.matrix<2>();
  EXPECT_NEAR(std::sqrt(noise_px.squaredNorm() / 4000.0), 0.5, 0.03) << "seed 6";
}

TEST(MatchTrials, DependOnSeedAndNumberAlone) {
  Trials one("{matches: 20, inlier_rate: 0.5}", 1), other("{matches: 20, inlier_rate: 0.5}", 2);
  Trials reseeded("{matches: 20, inlier_rate: 0.5, seed: 2}");
  const auto later = trial_of(other.read(5));
  const auto first = trial_of(one.read(0)), fifth = trial_of(one.read(5));
  EXPECT_TRUE(fifth.matches.image_px.matrix<2>() == later.matches.image_px.matrix<2>());
  EXPECT_TRUE(fifth.truth.points_m.matrix<3>() == later.truth.points_m.matrix<3>());
  EXPECT_TRUE(first.truth.points_m.matrix<3>() != fifth.truth.points_m.matrix<3>());
  EXPECT_TRUE(trial_of(reseeded.read(5)).truth.points_m.matrix<3>() !=
              fifth.truth.points_m.matrix<3>());
}

TEST(MatchTrials, HaveTheSameShapesAndTemplatePointsAtEveryCorrectRate) {
  Trials few("{matches: 50, inlier_rate: 0.2}"), most("{matches: 50, inlier_rate: 0.9}");
  Trials dense("{matches: 500}");
  const auto a = trial_of(few.read(8)), b = trial_of(most.read(8)), c = trial_of(dense.read(8));
  EXPECT_TRUE(a.truth.points_m.matrix<3>() == b.truth.points_m.matrix<3>());
  EXPECT_TRUE(a.truth.points_m.matrix<3>() == c.truth.points_m.matrix<3>());
  EXPECT_TRUE(a.matches.template_px.matrix<2>() == b.matches.template_px.matrix<2>());
}

TEST(MatchTrials, SayWhatToChangeWhereNoShapeIsAccepted) {
  Trials trials("{max_strain: 0, max_draws: 3}");
  const PluginAnswer outcome = trials.read(0);
  EXPECT_EQ(outcome.status, WEFT_ERROR);
  EXPECT_EQ(outcome.message.rfind("none of 3 shapes", 0), 0U) << outcome.message;
}

TEST(MatchTrials, RefuseATrialThatDoesNotExist) {
  Trials trials("{trials: 2}");
  const PluginAnswer outcome = trials.read(2);
  EXPECT_EQ(outcome.status, WEFT_ERROR);
  EXPECT_EQ(outcome.message, "there is no trial 2: the source has 2, counted from 0");
}

}  // namespace
}  // namespace weft::testing
