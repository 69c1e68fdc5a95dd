// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <functional>
#include <iostream>
#include <weft/core/rng.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/barycentric.hpp>
#include <weft/testing/synthetic.hpp>

#include "pipeline/survey/template_faults.hpp"
#include "support/charted_objects.hpp"

namespace weft::chart_matches_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr std::uint64_t kSeed = 20261130;
constexpr int kFacesPerSide = 2 * 8 * 8;

/// A cube of six charts whose corner points to the camera, 0.5 m away: the sides 1, 3 and 5 (+x, +y
/// and +z) are visible.
struct CubeScene {
  Template templ = charted::charted_cube(9);
  Camera camera = testing::make_camera();
  Faces faces = templ.faces.matrix<3>();
  Points3 vertices_m;

  CubeScene() {
    std::cout << "seed " << kSeed << "\n";
    const Eigen::Matrix3d rotation =
        Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d(1.0, 1.0, 1.0),
                                           Eigen::Vector3d(0.0, 0.0, -1.0))
            .toRotationMatrix();
    vertices_m = templ.vertices_m.matrix<3>() * rotation.transpose();
    vertices_m.col(2).array() += 0.5;
  }

  /// `count` kept matches on the sides for which `shown` holds, with noise of 0.5 px.
  Correspondences matches(int count, const std::function<bool(int)>& shown) const {
    Rng rng(kSeed);
    Correspondences made;
    made.template_px = Array<double>({count, 2});
    made.image_px = Array<double>({count, 2});
    made.kept = Array<std::uint8_t>({count}, 1);
    for (int i = 0; i < count; ++i) {
      std::int32_t face = 0;
      do {
        face = static_cast<std::int32_t>(rng.below(static_cast<std::uint32_t>(faces.rows())));
      } while (!shown(face / kFacesPerSide));
      double a = rng.uniform(), b = rng.uniform();
      if (a + b > 1.0) a = 1.0 - a, b = 1.0 - b;
      const Eigen::Vector3d weights(a, b, 1.0 - a - b);
      const Eigen::Vector2d place_px = interpolate(templ.flat_px.matrix<2>(), faces, face, weights);
      const Eigen::Vector2d pixel =
          project(testing::pinhole(camera), interpolate(vertices_m, faces, face, weights));
      for (int axis = 0; axis < 2; ++axis) {
        made.template_px(i, axis) = place_px[axis];
        made.image_px(i, axis) = pixel[axis] + 0.5 * rng.normal();
      }
    }
    return made;
  }

  std::vector<std::string> faults(const Correspondences& matches) const {
    FirstLook look{matches.count(), 0, 250.0, fit_flipped(templ, camera, matches)};
    look.charts = chart_matches(templ, camera, {matches});
    return faults_of(look);
  }
};

bool is_visible(int side) { return side % 2 == 1; }

TEST(ChartMatches, AreNotRequiredOnSidesThatFaceAway) {
  const CubeScene scene;
  const Correspondences matches = scene.matches(300, is_visible);
  const auto charts = chart_matches(scene.templ, scene.camera, {matches});
  ASSERT_TRUE(charts);
  EXPECT_EQ(charts->judged, 3);
  EXPECT_EQ(charts->unmatched, 0);
  EXPECT_EQ(charts->unmatched_share, 0.0);
  EXPECT_THAT(scene.faults(matches), IsEmpty());
}

TEST(ChartMatches, AreAFaultIfOnlyOneVisibleSideHasThem) {
  const CubeScene scene;
  const Correspondences matches = scene.matches(300, [](int side) { return side == 3; });
  const auto charts = chart_matches(scene.templ, scene.camera, {matches});
  ASSERT_TRUE(charts);
  EXPECT_EQ(charts->judged, 3);
  EXPECT_EQ(charts->unmatched, 2);
  EXPECT_NEAR(charts->unmatched_share, 2.0 / 3.0, 0.05);
  EXPECT_THAT(scene.faults(matches),
              ElementsAre(HasSubstr("% of the object gets no match: 2 of 3 charts")));
}

TEST(ChartMatches, OfTwoPhotographsCountTogether) {
  const CubeScene scene;
  const auto on = [&](int one) {
    return scene.matches(100, [one](int side) { return side == one; });
  };
  const auto first = chart_matches(scene.templ, scene.camera, {on(1)});
  const auto all = chart_matches(scene.templ, scene.camera, {on(1), on(3), on(5)});
  EXPECT_EQ(first->unmatched, 2);
  EXPECT_EQ(all->unmatched, 0);
}

TEST(ChartMatches, OfASmallPartAreNoFault) {
  const CubeScene scene;
  FirstLook look{200, 0, 250.0,
                 fit_flipped(scene.templ, scene.camera, scene.matches(200, is_visible))};
  look.charts = ChartMatches{12, 2, 0.19};
  EXPECT_THAT(faults_of(look), IsEmpty());
  look.charts = ChartMatches{12, 2, 0.2};
  EXPECT_THAT(faults_of(look), ElementsAre(HasSubstr("20 % of the object gets no match: 2 of 12")));
}

TEST(ChartMatches, AreNotJudgedForOneChartAndWithoutAPose) {
  const CubeScene scene;
  EXPECT_FALSE(
      chart_matches(testing::make_template(), scene.camera, {scene.matches(100, is_visible)}));
  EXPECT_FALSE(chart_matches(scene.templ, scene.camera, {scene.matches(5, is_visible)}));
  EXPECT_FALSE(chart_matches(scene.templ, scene.camera, {}));
}

TEST(ChartMatches, AreNotRequiredOnSidesBehindOthers) {
  // A wall of one chart in front of a wall of another one, both towards the camera.
  charted::ChartBuilder builder;
  for (const double z_m : {-0.05, 0.05}) {
    builder.add(9, 9, [z_m](int i, int j) {
      const double size_m = z_m < 0.0 ? 0.1 : 0.08;  // the hidden one is smaller
      return charted::Place{size_m * (i / 8.0 - 0.5), -size_m * (j / 8.0 - 0.5), z_m};
    });
  }
  CubeScene scene;
  scene.templ = builder.build();
  scene.faces = scene.templ.faces.matrix<3>();
  scene.vertices_m = scene.templ.vertices_m.matrix<3>();
  scene.vertices_m.col(2).array() += 0.5;
  const auto charts = chart_matches(scene.templ, scene.camera,
                                    {scene.matches(200, [](int wall) { return wall == 0; })});
  ASSERT_TRUE(charts);
  EXPECT_EQ(charts->judged, 1);
  EXPECT_EQ(charts->unmatched, 0);
}

}  // namespace
}  // namespace weft::chart_matches_test
