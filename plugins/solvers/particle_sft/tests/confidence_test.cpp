// SPDX-License-Identifier: Apache-2.0
#include "confidence.hpp"

#include <gtest/gtest.h>

#include <iostream>

#include "scene.hpp"

namespace weft::particle_sft {
namespace {

using testing::PluginUnderTest;

/// Five matches in each face of the sheet, all kept, all off by the same in the image.
Correspondences matches_of(const Scene& scene, double off_px) {
  const Faces faces = scene.templ.faces.matrix<3>();
  const std::int64_t count = 5 * faces.rows();
  std::cout << "seed " << kSeed << "\n";
  Rng rng(kSeed);
  Correspondences matches;
  matches.template_px = Array<double>({count, 2});
  matches.image_px = Array<double>({count, 2});
  matches.face = Array<std::int32_t>({count});
  matches.barycentrics = Array<double>({count, 3});
  matches.kept = Array<std::uint8_t>({count});
  matches.score = Array<double>({count});
  for (std::int64_t i = 0; i < count; ++i) {
    const double a = rng.uniform(0.0, 0.5), b = rng.uniform(0.0, 0.5);
    const Eigen::Vector3d weights(a, b, 1.0 - a - b);
    matches.face(i) = static_cast<std::int32_t>(i % faces.rows());
    matches.barycentrics.matrix<3>().row(i) = weights.transpose();
    Eigen::Vector3d point_m = Eigen::Vector3d::Zero();
    for (int k = 0; k < 3; ++k) {
      point_m += weights[k] * scene.truth_m.row(faces(matches.face(i), k)).transpose();
    }
    matches.image_px.matrix<2>().row(i) =
        project(testing::pinhole(scene.camera), point_m).transpose();
    matches.image_px(i, 0) += off_px;
    matches.kept(i) = 1;
  }
  return matches;
}

/// A shape and the memory that it lies in.
struct Solved {
  testing::Outcome outcome;
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
  const solvers::Agreement many{300, 290};
  const double best = confidence(good, many);
  EXPECT_GT(best, confidence({1.0, 0.001, 1.0, false}, many));
  EXPECT_GT(best, confidence({0.1, 0.01, 1.0, false}, many));
  EXPECT_GT(best, confidence(good, {300, 100}));
  EXPECT_GT(best, confidence(good, {30, 29}));
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
