// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <weft/core/index.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/barycentric.hpp>
#include <weft/geometry/mesh_topology.hpp>
#include <weft/geometry/mesh_validation.hpp>
#include <weft/testing/random_sheet.hpp>

namespace weft::testing {
namespace {

bool same_bytes(const Array<double>& a, const Array<double>& b) {
  return a.size() == b.size() &&
         std::memcmp(a.data(), b.data(), to_index(a.size()) * sizeof(double)) == 0;
}

TEST(SyntheticTemplate, IsAValidFlatMeshInMetresAndPixels) {
  const SheetSpec sheet;
  const Template templ = make_template(sheet);
  ASSERT_TRUE(validate_flat_mesh(templ.flat_px.matrix<2>(), templ.faces.matrix<3>()));
  ASSERT_TRUE(validate_mesh(templ.vertices_m.matrix<3>(), templ.faces.matrix<3>()));
  EXPECT_EQ(templ.vertices_m.rows(), 60);
  EXPECT_EQ(templ.flat_px(0, 0), -0.5);
  EXPECT_EQ(templ.flat_px(59, 0), 959.5);
  EXPECT_EQ(templ.flat_px(59, 1), 574.5);
  const Eigen::RowVector3d size =
      templ.vertices_m.matrix<3>().row(59) - templ.vertices_m.matrix<3>().row(0);
  EXPECT_NEAR(size.x(), sheet.width_m, 1e-15);
  EXPECT_NEAR(size.y(), sheet.height_m, 1e-15);
  EXPECT_NEAR(templ.m_per_px(0) * 959.5, templ.vertices_m(59, 0), 1e-15);
}

TEST(SyntheticPose, PutsTheMiddleOfTheSheetWhereItIsAsked) {
  const SheetSpec sheet;
  const Template templ = make_template(sheet);
  const PoseSpec pose{0.7, 0.03, -0.02, 0.3, -0.2, 0.5};
  const Points3 moved = bent_vertices(templ, make_bent_sheet(sheet, {}, pose));
  const Eigen::RowVector3d middle = moved.colwise().mean();
  EXPECT_LT((middle - Eigen::RowVector3d(0.03, -0.02, 0.7)).norm(), 1e-14);
}

TEST(SyntheticPose, ThrowsOnABendThatIsNotLegal) {
  EXPECT_THROW(make_cylinder({}, 0.0, 0.0), std::invalid_argument);
}

TEST(SyntheticMatches, LieOnTheirFacesAndProjectFromTheMesh) {
  const SheetSpec sheet;
  const Template templ = make_template(sheet);
  const Camera camera = make_camera();
  const Points3 vertices = bent_vertices(templ, make_cylinder(sheet, 0.2, 0.4));
  Rng rng(3);
  MatchSpec spec;
  spec.count = 300;
  const LabelledMatches drawn = draw_matches(templ, camera, vertices, spec, rng);
  const Points2 flat = templ.flat_px.matrix<2>();
  const Faces faces = templ.faces.matrix<3>();
  for (Eigen::Index i = 0; i < 300; ++i) {
    const Eigen::Vector3d weights = drawn.matches.barycentrics.matrix<3>().row(i);
    const std::int32_t face = drawn.matches.face(i);
    ASSERT_GE(weights.minCoeff(), -1e-9);
    const Eigen::Vector2d point = drawn.matches.template_px.matrix<2>().row(i);
    ASSERT_LT((interpolate(flat, faces, face, weights) - point).norm(), 1e-9);
    const Eigen::Vector2d pixel =
        project(pinhole(camera), interpolate(vertices, faces, face, weights));
    ASSERT_LT((pixel - Eigen::Vector2d(drawn.matches.image_px.matrix<2>().row(i))).norm(), 1e-9);
    ASSERT_EQ(drawn.correct[to_index(i)], 1);
    ASSERT_EQ(drawn.matches.kept(i), 1);
  }
}

TEST(SyntheticMatches, OfTheSmoothSheetDifferFromTheMeshByItsSagitta) {
  const SheetSpec sheet;
  const Template templ = make_template(sheet);
  const DevelopableSheet bent = make_cylinder(sheet, 0.2, 0.0);
  const Points3 vertices = bent_vertices(templ, bent);
  MatchSpec spec;
  Rng first(4), second(4);
  const LabelledMatches mesh = draw_matches(templ, make_camera(), vertices, spec, first);
  const LabelledMatches smooth = draw_matches(templ, make_camera(), bent, spec, second);
  ASSERT_TRUE(same_bytes(mesh.matches.template_px, smooth.matches.template_px));
  const double largest = (mesh.true_px - smooth.true_px).rowwise().norm().maxCoeff();
  EXPECT_GT(largest, 0.02);
  EXPECT_LT(largest, 1.0);
}

TEST(SyntheticMatches, AreWrongAtTheRateThatIsAsked) {
  const SheetSpec sheet;
  const Template templ = make_template(sheet);
  const Camera camera = make_camera();
  Rng rng(5);
  MatchSpec spec;
  spec.count = 1000;
  spec.correct_rate = 0.3;
  const LabelledMatches drawn =
      draw_matches(templ, camera, bent_vertices(templ, make_cylinder(sheet, 0.3, 0.0)), spec, rng);
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  int lucky = 0;
  for (Eigen::Index i = 0; i < 1000; ++i) {
    if (i < 700) {
      mean += drawn.matches.image_px.matrix<2>().row(i).transpose() / 700.0;
      lucky += drawn.correct[to_index(i)];
    } else {
      ASSERT_EQ(drawn.correct[to_index(i)], 1);
    }
  }
  // A disc of 2 px in 640 x 480 has a chance of 4e-5.
  EXPECT_LE(lucky, 2);
  EXPECT_NEAR(mean.x(), 319.5, 30.0);
  EXPECT_NEAR(mean.y(), 239.5, 25.0);
}

TEST(SyntheticMatches, HaveTheNoiseThatIsAsked) {
  const SheetSpec sheet;
  const Template templ = make_template(sheet);
  Rng rng(6);
  MatchSpec spec;
  spec.count = 4000;
  spec.noise_px = 0.5;
  const LabelledMatches drawn =
      draw_matches(templ, make_camera(), make_cylinder(sheet, 0.3, 0.0), spec, rng);
  const Points2 error = drawn.matches.image_px.matrix<2>() - drawn.true_px;
  EXPECT_NEAR(std::sqrt(error.squaredNorm() / 8000.0), 0.5, 0.02);
  EXPECT_LT(error.colwise().mean().norm(), 0.03);
}

TEST(SyntheticMatches, AreTheSameForTheSameSeedOnly) {
  const SheetSpec sheet;
  const Template templ = make_template(sheet);
  const DevelopableSheet bent = make_cylinder(sheet, 0.3, 0.0);
  const auto pixels = [&](std::uint64_t seed) {
    Rng rng(seed);
    return draw_matches(templ, make_camera(), bent, {}, rng).matches.image_px;
  };
  EXPECT_TRUE(same_bytes(pixels(7), pixels(7)));
  EXPECT_FALSE(same_bytes(pixels(7), pixels(8)));
}

TEST(RandomDeformation, StaysInTheImageWithLittleStrainAndBends) {
  const SheetSpec sheet;
  const Template templ = make_template(sheet);
  const Camera camera = make_camera();
  const auto topology = build_topology(templ.faces.matrix<3>(), templ.vertices_m.rows());
  const Points3 rest = templ.vertices_m.matrix<3>();
  Rng rng(8);
  int draws = 0;
  double depth_range_m = 0.0;
  for (int trial = 0; trial < 100; ++trial) {
    const auto drawn = draw_deformation(sheet, camera, rng);
    ASSERT_TRUE(drawn);
    draws += drawn->draws;
    ASSERT_TRUE(all_in_image(camera, drawn->vertices_m));
    for (Eigen::Index e = 0; e < topology->edges.rows(); ++e) {
      const auto i = topology->edges(e, 0), j = topology->edges(e, 1);
      const double length = (drawn->vertices_m.row(i) - drawn->vertices_m.row(j)).norm();
      ASSERT_LE(std::abs(length / (rest.row(i) - rest.row(j)).norm() - 1.0), 0.08);
    }
    const Eigen::VectorXd z = drawn->vertices_m.col(2);
    depth_range_m += (z.maxCoeff() - z.minCoeff()) / 100.0;
  }
  EXPECT_LT(draws, 400);
  EXPECT_GT(depth_range_m, 0.04);
  EXPECT_LT(depth_range_m, 0.3);
}

TEST(RandomDeformation, MovesTheTwoCellsRigidly) {
  const SheetSpec sheet;
  const Points3 rest = make_template(sheet).vertices_m.matrix<3>();
  Rng rng(9);
  const auto drawn = draw_deformation(sheet, make_camera(), rng);
  ASSERT_TRUE(drawn);
  for (const int corner : {20, 28}) {
    for (const int other : {corner + 1, corner + 10, corner + 11}) {
      EXPECT_NEAR((drawn->vertices_m.row(corner) - drawn->vertices_m.row(other)).norm(),
                  (rest.row(corner) - rest.row(other)).norm(), 1e-12);
    }
  }
}

TEST(RandomDeformation, SaysWhenNoDrawIsWithinTheLimits) {
  Rng rng(10);
  RandomDeformationSpec spec;
  spec.max_strain = 0.0;
  spec.max_draws = 3;
  const auto drawn = draw_deformation({}, make_camera(), rng, spec);
  ASSERT_FALSE(drawn);
  EXPECT_EQ(drawn.error().code, Errc::no_result);
}

}  // namespace
}  // namespace weft::testing
