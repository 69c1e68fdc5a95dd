// SPDX-License-Identifier: Apache-2.0
#include "tetrahedra.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "tests/solids.hpp"

namespace weft::volume {
namespace {

using ::testing::HasSubstr;

ClosedSurface surface_of(const TestMesh& mesh) {
  auto surface = closed_surface_of(mesh.as_template());
  EXPECT_TRUE(surface) << (surface ? "" : surface.error().message);
  return surface ? *std::move(surface) : ClosedSurface{};
}

std::string refusal_of(const TestMesh& mesh) {
  const auto surface = closed_surface_of(mesh.as_template());
  EXPECT_FALSE(surface);
  return surface ? "" : surface.error().message;
}

/// Filled, with what holds for every solid checked.
Solid filled(const ClosedSurface& surface, double pitch_m) {
  auto made = fill_with_tetrahedra(surface, pitch_m);
  EXPECT_TRUE(made) << (made ? "" : made.error().message);
  if (!made) return {};
  Solid solid = *std::move(made);
  EXPECT_TRUE(validate_tetrahedra(solid.nodes_m, solid.tetrahedra));
  for (Eigen::Index e = 0; e < solid.tetrahedra.rows(); ++e) {
    EXPECT_NEAR(tetrahedron_volume(solid.nodes_m, solid.tetrahedra, e), std::pow(pitch_m, 3) / 12.0,
                1e-9 * std::pow(pitch_m, 3));
    EXPECT_GE(solid.filled_share[to_index(e)], 0.05);
    EXPECT_LE(solid.filled_share[to_index(e)], 1.0);
  }
  for (Eigen::Index v = 0; v < surface.vertices_m.rows(); ++v) {
    EXPECT_GE(solid.vertex_barycentric.row(v).minCoeff(), -1e-9);
    EXPECT_NEAR(solid.vertex_barycentric.row(v).sum(), 1.0, 1e-12);
    Eigen::RowVector3d place = Eigen::RowVector3d::Zero();
    for (int k = 0; k < 4; ++k) {
      const std::int32_t node = solid.tetrahedra(solid.vertex_tetrahedron[to_index(v)], k);
      place += solid.vertex_barycentric(v, k) * solid.nodes_m.row(node);
    }
    EXPECT_LT((place - surface.vertices_m.row(v)).norm(), 1e-12);
  }
  return solid;
}

double filled_volume_m3(const Solid& solid) {
  double sum = 0.0;
  for (Eigen::Index e = 0; e < solid.tetrahedra.rows(); ++e) {
    sum += solid.filled_share[to_index(e)] * tetrahedron_volume(solid.nodes_m, solid.tetrahedra, e);
  }
  return sum;
}

double kept_volume_m3(const Solid& solid) {
  double sum = 0.0;
  for (Eigen::Index e = 0; e < solid.tetrahedra.rows(); ++e) {
    sum += tetrahedron_volume(solid.nodes_m, solid.tetrahedra, e);
  }
  return sum;
}

TEST(Tetrahedra, FillACube) {
  const ClosedSurface cube = surface_of(box_mesh({0.1, 0.1, 0.1}));
  EXPECT_NEAR(cube.volume_m3, 0.001, 1e-15);
  for (const double pitch_m : {0.0144, 0.01, 0.02}) {
    const Solid solid = filled(cube, pitch_m);
    EXPECT_NEAR(filled_volume_m3(solid), 0.001, 0.05 * 0.001) << pitch_m;
    EXPECT_GE(kept_volume_m3(solid), 0.001) << pitch_m;
    EXPECT_EQ(solid.parts, 1);
  }
}

TEST(Tetrahedra, FillABall) {
  const ClosedSurface ball = surface_of(ball_mesh(0.05, 24, 32));
  const Solid solid = filled(ball, 0.0144);
  EXPECT_NEAR(filled_volume_m3(solid), ball.volume_m3, 0.05 * ball.volume_m3);
  EXPECT_EQ(solid.parts, 1);
}

TEST(Tetrahedra, LeaveOutTheBoreOfAHose) {
  const ClosedSurface hose = surface_of(hose_mesh(0.05, 0.03, 0.1, 48));
  const Solid solid = filled(hose, 0.01);
  EXPECT_NEAR(filled_volume_m3(solid), hose.volume_m3, 0.06 * hose.volume_m3);
  EXPECT_GT(solid.nodes_m.leftCols<2>().rowwise().norm().minCoeff(), 0.03 - 0.015);
  EXPECT_EQ(solid.parts, 1);
}

TEST(Tetrahedra, KeepAPlateThinnerThanThePitch) {
  const ClosedSurface plate = surface_of(box_mesh({0.2, 0.1, 0.001}));
  const Solid solid = filled(plate, 0.02);
  EXPECT_EQ(solid.parts, 1);
  // The plate is covered completely: its upper side is within the kept tetrahedra.
  double covered_m2 = 0.0;
  constexpr int kSteps = 50;
  for (int i = 0; i < kSteps; ++i) {
    for (int j = 0; j < kSteps; ++j) {
      const Eigen::Vector3d at(0.2 * ((i + 0.5) / kSteps - 0.5), 0.1 * ((j + 0.5) / kSteps - 0.5),
                               0.0004);
      for (Eigen::Index e = 0; e < solid.tetrahedra.rows(); ++e) {
        Eigen::Matrix4d nodes;
        for (int k = 0; k < 4; ++k) {
          nodes.col(k) << solid.nodes_m.row(solid.tetrahedra(e, k)).transpose(), 1.0;
        }
        if ((nodes.inverse() * at.homogeneous()).minCoeff() < -1e-9) continue;
        covered_m2 += 0.02 / (kSteps * kSteps);
        break;
      }
    }
  }
  EXPECT_NEAR(covered_m2, 0.02, 1e-9);
}

TEST(Tetrahedra, KeepASlantedRodThinnerThanThePitch) {
  TestMesh rod = box_mesh({0.2, 0.002, 0.002});
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(0.3, 0.5, 0.8).normalized()).toRotationMatrix();
  rod.vertices_m = rod.vertices_m * turn.transpose();
  EXPECT_EQ(filled(surface_of(rod), 0.02).parts, 1);
}

TEST(Tetrahedra, AreTheSameEachTime) {
  const ClosedSurface ball = surface_of(ball_mesh(0.05, 12, 16));
  const Solid first = filled(ball, 0.012), second = filled(ball, 0.012);
  EXPECT_EQ(first.nodes_m, second.nodes_m);
  EXPECT_EQ(first.tetrahedra, second.tetrahedra);
  EXPECT_EQ(first.filled_share, second.filled_share);
  EXPECT_EQ(first.vertex_tetrahedron, second.vertex_tetrahedron);
  EXPECT_EQ(first.vertex_barycentric, second.vertex_barycentric);
}

TEST(Tetrahedra, KeepTwoObjectsSeparate) {
  TestMesh both = box_mesh({0.05, 0.05, 0.05});
  both.add(box_mesh({0.05, 0.05, 0.05}, {0.15, 0.0, 0.0}));
  const ClosedSurface surface = surface_of(both);
  EXPECT_EQ(surface.parts, 2);
  EXPECT_EQ(filled(surface, 0.01).parts, 2);
}

TEST(Tetrahedra, RefuseAPitchThatDoesNotSuitTheObject) {
  const ClosedSurface cube = surface_of(box_mesh({0.1, 0.1, 0.1}));
  const auto refusal = [&](double pitch_m) {
    const auto made = fill_with_tetrahedra(cube, pitch_m);
    EXPECT_FALSE(made) << pitch_m;
    if (made) return std::string();
    EXPECT_EQ(made.error().subject, "pitch_m");
    return made.error().message;
  };
  EXPECT_THAT(refusal(0.11), HasSubstr("is larger than the object, which is 100 mm long"));
  EXPECT_THAT(refusal(1e-4), HasSubstr("more than 1000000 cubes"));
  EXPECT_THAT(refusal(1e-300), HasSubstr("more than 1000000 cubes"));
  EXPECT_THAT(refusal(0.004), HasSubstr("nodes, legal are 20000: give a 'pitch_m' of about"));
}

TEST(ClosedSurface, ReportsOpenEdges) {
  TestMesh open = box_mesh({0.1, 0.1, 0.1});
  open.faces.conservativeResize(10, 3);
  EXPECT_THAT(refusal_of(open), HasSubstr("is not closed: 4 of its 17 edges have one face only"));
}

TEST(ClosedSurface, ReportsAFaceThatIsTurned) {
  TestMesh mixed = box_mesh({0.1, 0.1, 0.1});
  std::swap(mixed.faces(11, 1), mixed.faces(11, 2));
  EXPECT_THAT(refusal_of(mixed), HasSubstr("changes its orientation at face 11"));
}

TEST(ClosedSurface, ReportsASurfaceThatIsInsideOut) {
  TestMesh turned = box_mesh({0.1, 0.1, 0.1});
  turned.turn_inside_out();
  EXPECT_THAT(refusal_of(turned), HasSubstr("is turned inside out"));
}

TEST(ClosedSurface, ReportsAVertexThatIsNotFinite) {
  TestMesh broken = box_mesh({0.1, 0.1, 0.1});
  broken.vertices_m(5, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(refusal_of(broken), HasSubstr("vertex 5 is not finite"));
}

}  // namespace
}  // namespace weft::volume
