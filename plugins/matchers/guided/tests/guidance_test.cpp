// SPDX-License-Identifier: Apache-2.0
#include "guidance.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <weft/core/index.hpp>
#include <weft/data/matrix.hpp>
#include <weft/testing/synthetic.hpp>

#include "common/tests/keypoints_of.hpp"

namespace weft::guided {
namespace {

using testing::SheetSpec;

TEST(PredictedPlaces, AreThoseOfThePointsOfTheMesh) {
  std::printf("seed 1\n");
  Rng rng(1);
  const SheetSpec sheet;
  const Template templ = testing::make_template(sheet);
  const Camera camera = testing::make_camera();
  Shape shape;
  shape.vertices_m =
      make_array<double>(testing::bent_vertices(templ, testing::make_cylinder(sheet, 0.2, 0.5)));
  const auto drawn =
      testing::draw_matches(templ, camera, shape.vertices_m.matrix<3>(), {.count = 50}, rng);
  Keypoints keypoints = matchers::keypoints_on_grid(50);
  keypoints.face = drawn.matches.face;
  keypoints.barycentrics = drawn.matches.barycentrics;
  keypoints.face(7) = -1;
  keypoints.face(8) = 100'000;
  const auto places = predicted_places(keypoints, templ, camera, shape);
  ASSERT_EQ(places.size(), 50U);
  for (int i = 0; i < 50; ++i) {
    if (i == 7 || i == 8) {
      EXPECT_FALSE(places[to_index(i)].allFinite());
    } else {
      EXPECT_LT((places[to_index(i)] - drawn.true_px.row(i).transpose()).norm(), 1e-9);
    }
  }
  shape.vertices_m.matrix<3>().col(2) *= -1.0;
  for (const auto& place : predicted_places(keypoints, templ, camera, shape)) {
    EXPECT_FALSE(place.allFinite()) << "behind the camera";
  }
}

struct Moved {
  Correspondences matches;
  std::vector<Eigen::Vector2d> predicted_px;
};

/// Template points on a grid, moved by `motion`.
template <class Motion>
Moved moved_by(int count, Motion&& motion) {
  Moved moved;
  moved.matches.template_px = Array<double>({count, 2}, 0.0);
  moved.matches.image_px = Array<double>({count, 2}, 0.0);
  moved.matches.template_keypoint = Array<std::int32_t>({count}, 0);
  for (int n = 0; n < count; ++n) {
    const Eigen::Vector2d at(10.0 * (n % 30), 10.0 * (n / 30));
    const Eigen::Vector2d to = at + motion(at);
    moved.predicted_px.push_back(at);
    for (int k = 0; k < 2; ++k) {
      moved.matches.template_px(n, k) = at[k];
      moved.matches.image_px(n, k) = to[k];
    }
    moved.matches.template_keypoint(n) = n;
  }
  return moved;
}

TEST(AgreeingMatches, AreAllOfASheetThatMovesTurnsOrGrows) {
  const auto shifted = moved_by(600, [](const Eigen::Vector2d&) { return Eigen::Vector2d(28, 5); });
  EXPECT_EQ(agreeing_matches(shifted.matches, shifted.predicted_px, 30.0), 600);
  const auto grown = moved_by(600, [](const Eigen::Vector2d& at) -> Eigen::Vector2d {
    return 0.08 * (at - Eigen::Vector2d(150, 100));
  });
  EXPECT_EQ(agreeing_matches(grown.matches, grown.predicted_px, 30.0), 600);
}

TEST(AgreeingMatches, AreFewOfMatchesToAnything) {
  std::printf("seed 2\n");
  Rng rng(2);
  const auto scattered = moved_by(600, [&](const Eigen::Vector2d&) -> Eigen::Vector2d {
    const double angle = rng.uniform(0.0, 6.3), radius = 30.0 * std::sqrt(rng.uniform());
    return {radius * std::cos(angle), radius * std::sin(angle)};
  });
  EXPECT_LT(agreeing_matches(scattered.matches, scattered.predicted_px, 30.0), 90);
}

TEST(AgreeingMatches, AreNoneWhereTwoMatchesMakeAPart) {
  const auto two = moved_by(2, [](const Eigen::Vector2d&) { return Eigen::Vector2d(0, 0); });
  EXPECT_EQ(agreeing_matches(two.matches, two.predicted_px, 30.0), 0);
  EXPECT_EQ(agreeing_matches(Correspondences{}, {}, 30.0), 0);
}

}  // namespace
}  // namespace weft::guided
