// SPDX-License-Identifier: Apache-2.0
#include "confidence.hpp"

#include <gtest/gtest.h>

#include <iostream>

#include "scene.hpp"

namespace weft::brunet_mdh {
namespace {

constexpr std::uint64_t kMatchSeed = 20261121;

/// Inliers with noise of half a pixel, moved aside.
Correspondences matches_of(const Scene& scene, int count, double off_px) {
  std::cout << "seed " << kMatchSeed << "\n";
  Rng rng(kMatchSeed);
  Correspondences matches =
      testing::draw_matches(scene.templ, scene.camera, scene.truth_m, {count, 1.0, 0.5}, rng)
          .matches;
  for (std::int64_t i = 0; i < matches.count(); ++i) matches.image_px(i, 0) += off_px;
  return matches;
}

double said(const Scene& scene, const Correspondences* matches) {
  testing::PluginUnderTest plugin("solvers/brunet_mdh");
  std::vector<testing::Input> inputs{testing::input("template", scene.templ),
                                     testing::input("camera", scene.camera),
                                     testing::input("sightlines", scene.lines)};
  if (matches != nullptr) inputs.push_back(testing::input("correspondences", *matches));
  return plugin.process(0, inputs).get<Shape>().value().confidence;
}

TEST(Confidence, IsHighWhereTheMatchesAgreeAndLowWhereTheyDoNot) {
  const Scene scene = Scene::bent(0.25);
  const Correspondences right = matches_of(scene, 400, 0.0), off = matches_of(scene, 400, 10.0);
  EXPECT_GT(said(scene, &right), 0.75);
  EXPECT_LT(said(scene, &off), 0.25);
}

TEST(Confidence, IsMultipliedByThatOfTheFilters) {
  const Scene scene = Scene::bent(0.25);
  Correspondences matches = matches_of(scene, 400, 0.0);
  const double alone = said(scene, &matches);
  matches.confidence = make_scalar(0.4);
  EXPECT_DOUBLE_EQ(said(scene, &matches), 0.4 * alone);
}

TEST(Confidence, FallsWithEachSignOfTrouble) {
  const double best = confidence(0.002, 290);
  EXPECT_GT(best, confidence(0.03, 290));
  EXPECT_GT(best, confidence(0.002, 29));
}

}  // namespace
}  // namespace weft::brunet_mdh
