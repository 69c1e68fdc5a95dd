// SPDX-License-Identifier: Apache-2.0
#include "confidence.hpp"

#include <gtest/gtest.h>

#include <iostream>
#include <weft/data/matrix.hpp>

#include "scene.hpp"

namespace weft::particle_sft {
namespace {

using testing::PluginUnderTest;

/// Inliers without noise, five for each face of the surface, moved aside in the image.
Correspondences matches_of(const Scene& scene, double off_px) {
  const int count = 5 * static_cast<int>(scene.templ.faces.rows());
  std::cout << "seed " << kSeed << "\n";
  Rng rng(kSeed);
  Correspondences matches =
      testing::draw_matches(scene.templ, scene.camera, scene.truth_m, {count, 1.0, 0.0}, rng)
          .matches;
  for (std::int64_t i = 0; i < matches.count(); ++i) matches.image_px(i, 0) += off_px;
  return matches;
}

/// A shape and the memory that it lies in.
struct Solved {
  testing::PluginAnswer outcome;
  Shape shape = outcome.get<Shape>().value();
};

Solved solved(const Scene& scene, const Correspondences* matches,
              const std::string& params = "{}") {
  PluginUnderTest plugin(kId, params);
  return {scene.run(plugin, nullptr, nullptr, matches)};
}

TEST(Confidence, IsHighWhereTheMatchesAgreeAndLowWhereTheyDoNot) {
  const Scene scene = Scene::bent(0.25);
  const Correspondences right = matches_of(scene, 0.0), off = matches_of(scene, 10.0);
  const Solved sure = solved(scene, &right), unsure = solved(scene, &off);
  EXPECT_GT(sure.shape.confidence, 0.9);
  EXPECT_LT(unsure.shape.confidence, 0.25);
  EXPECT_EQ(sure.shape.diag.value("agreeing_matches", -1.0), static_cast<double>(right.count()));
  EXPECT_EQ(unsure.shape.diag.value("agreeing_matches", -1.0), 0.0);
}

TEST(Confidence, IsMultipliedByThatOfTheFilters) {
  const Scene scene = Scene::bent(0.25);
  Correspondences matches = matches_of(scene, 0.0);
  const double alone = solved(scene, &matches).shape.confidence;
  matches.confidence = make_scalar(0.4);
  EXPECT_DOUBLE_EQ(solved(scene, &matches).shape.confidence, 0.4 * alone);
}

TEST(Confidence, IsOfTheSightlinesWhereNoMatchesAreWired) {
  const Scene scene = Scene::bent(0.25);
  const Solved alone = solved(scene, nullptr);
  const Shape& shape = alone.shape;
  EXPECT_EQ(shape.diag.value("agreeing_matches", -1.0), 60.0);
  EXPECT_GT(shape.confidence, 0.25);
  EXPECT_LE(shape.confidence, 1.0);
}

TEST(Confidence, FallsWithEachSignOfTrouble) {
  const Fit good{0.1, 0.001, 1.0, false};
  const ShapeEvidence many{300, 290, 1.0, 30};
  const double best = confidence(good, many);
  EXPECT_GT(best, confidence({1.0, 0.001, 1.0, false}, many));
  EXPECT_GT(best, confidence({0.1, 0.01, 1.0, false}, many));
  EXPECT_GT(best, confidence(good, {300, 100, 1.0, 30}));
  EXPECT_GT(best, confidence(good, {300, 290, 0.3, 30}));
}

TEST(Covariances, AreThereUnlessTheyAreTurnedOff) {
  const Scene scene = Scene::bent(0.25);
  const Correspondences matches = matches_of(scene, 0.0);
  const Solved with = solved(scene, &matches),
               without = solved(scene, &matches, "{covariance: false}");
  EXPECT_EQ(with.shape.covariance_m2.rows(), 60);
  EXPECT_FALSE(without.shape.covariance_m2.present());
  EXPECT_EQ(with.shape.vertices_m.matrix<3>(), without.shape.vertices_m.matrix<3>());
}

}  // namespace
}  // namespace weft::particle_sft
