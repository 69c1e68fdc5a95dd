// SPDX-License-Identifier: Apache-2.0
#include "../energy.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <iostream>
#include <stdexcept>
#include <weft/core/index.hpp>
#include <weft/core/rng.hpp>
#include <weft/data/matrix.hpp>
#include <weft/testing/synthetic.hpp>

namespace weft::collins_integrated {
namespace {

constexpr std::uint64_t kShapeSeed = 16;

/// A surface that is bent at rest, and one that contradicts both the observations and the lengths.
struct Crumpled {
  Template templ = testing::make_template();
  MeshModel mesh;
  FrameData frame;
  Points3 vertices_m;
  Energy energy;

  Crumpled() {
    std::cout << "seed " << kShapeSeed << "\n";
    Rng rng(kShapeSeed);
    const auto at_rest = testing::make_cylinder({}, 0.3, 0.4, {.distance_m = 0.5});
    templ.vertices_m = make_array<double>(testing::bent_vertices(templ, at_rest));
    if (!mesh.build(templ)) throw std::runtime_error("the template is no mesh");
    const auto sheet = testing::make_cylinder({}, 0.2, 0.9, {.distance_m = 0.6, .tilt_y_rad = 0.3});
    const Points3 seen_m = testing::bent_vertices(templ, sheet);
    vertices_m = seen_m;
    for (double& value : vertices_m.reshaped()) value += 2e-3 * rng.normal();
    frame.camera = testing::pinhole(testing::make_camera());
    frame.previous_m = seen_m;
    for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
      Observation seen;
      seen.face = static_cast<std::int32_t>(f);
      seen.weights = {0.2, 0.3 + 0.1 * rng.uniform(), 0.0};
      seen.weights[2] = 1.0 - seen.weights.sum();
      Eigen::Vector3d point = Eigen::Vector3d::Zero();
      for (Eigen::Index k = 0; k < 3; ++k) {
        point += seen.weights[k] * seen_m.row(mesh.faces(f, k)).transpose();
      }
      seen.seen_px =
          project(frame.camera, point) + 3.0 * Eigen::Vector2d(rng.normal(), rng.normal());
      seen.whitening_per_px << 0.5 + rng.uniform(), rng.uniform() - 0.5, rng.uniform() - 0.5,
          0.5 + rng.uniform();
      frame.matches.push_back(seen);
      seen.whitening_per_px.row(1).setZero();
      frame.texture.push_back(seen);
    }
    energy.prepare(mesh);
    energy.follow(vertices_m);
  }
};

TEST(Energy, ItsGradientIsThatOfFiniteDifferences) {
  for (const Loss loss : {Loss{2.45, false}, Loss{9.0, true}}) {
    Crumpled crumpled;
    Scales scales;
    scales.loss = loss;
    scales.previous_m = 0.01;
    Points3 gradient(60, 3);
    solvers::BlockMatrix matrix;
    matrix.diagonal.resize(60);
    matrix.coupling.resize(crumpled.mesh.couplings.size());
    const double here =
        crumpled.energy.linearise(crumpled.frame, scales, crumpled.vertices_m, gradient, matrix);
    EXPECT_DOUBLE_EQ(here, crumpled.energy.value(crumpled.frame, scales, crumpled.vertices_m));
    constexpr double kStep_m = 1e-7;
    const double largest = gradient.cwiseAbs().maxCoeff();
    ASSERT_GT(largest, 0.0);
    for (Eigen::Index k = 0; k < gradient.size(); ++k) {
      Points3 moved_m = crumpled.vertices_m;
      moved_m.data()[k] += kStep_m;
      const double beyond = crumpled.energy.value(crumpled.frame, scales, moved_m);
      moved_m.data()[k] -= 2.0 * kStep_m;
      const double before = crumpled.energy.value(crumpled.frame, scales, moved_m);
      const double half = 0.25 * (beyond - before) / kStep_m;
      EXPECT_NEAR(gradient.data()[k], half, 1e-5 * largest) << k;
    }
  }
}

TEST(Energy, ItsMatrixIsTheSecondDerivativeOfWhatIsMet) {
  Crumpled crumpled;
  // Where every observation is met and no edge is stretched the Gauss-Newton matrix is exact.
  Points3 rest_m = crumpled.mesh.rest_m;
  crumpled.energy.follow(rest_m);
  for (auto* observations : {&crumpled.frame.matches, &crumpled.frame.texture}) {
    for (Observation& seen : *observations) {
      Eigen::Vector3d point = Eigen::Vector3d::Zero();
      for (Eigen::Index k = 0; k < 3; ++k) {
        point += seen.weights[k] * rest_m.row(crumpled.mesh.faces(seen.face, k)).transpose();
      }
      seen.seen_px = project(crumpled.frame.camera, point);
    }
  }
  crumpled.frame.previous_m = rest_m;
  Scales scales;
  scales.strain = 0.1;
  scales.previous_m = 0.01;
  Points3 gradient(60, 3);
  solvers::BlockMatrix matrix;
  matrix.diagonal.resize(60);
  matrix.coupling.resize(crumpled.mesh.couplings.size());
  const double least = crumpled.energy.linearise(crumpled.frame, scales, rest_m, gradient, matrix);
  EXPECT_NEAR(least, 0.0, 1e-12);
  Rng rng(kShapeSeed + 1);
  for (int trial = 0; trial < 5; ++trial) {
    Points3 along(60, 3);
    for (double& value : along.reshaped()) value = rng.normal();
    double expected = 0.0;
    for (Eigen::Index v = 0; v < 60; ++v) {
      expected += along.row(v) * matrix.diagonal[to_index(v)] * along.row(v).transpose();
    }
    for (std::size_t c = 0; c < matrix.coupling.size(); ++c) {
      const auto [i, j] = crumpled.mesh.couplings[c];
      expected += 2.0 * along.row(i) * matrix.coupling[c] * along.row(j).transpose();
    }
    constexpr double kStep_m = 1e-6;
    const auto there = [&](double step_m) {
      return crumpled.energy.value(crumpled.frame, scales, rest_m + step_m * along);
    };
    const double found = 0.5 * (there(kStep_m) + there(-kStep_m)) / (kStep_m * kStep_m);
    EXPECT_NEAR(found, expected, 1e-4 * expected);
  }
}

TEST(Energy, ASheetThatIsBentAtRestCostsNothingHoweverItIsTurned) {
  Crumpled crumpled;
  crumpled.frame = {};
  const Eigen::Isometry3d pose =
      testing::make_pose({}, {.tilt_x_rad = 0.5, .tilt_y_rad = -0.8, .roll_rad = 1.1});
  Points3 turned_m = crumpled.mesh.rest_m;
  for (Eigen::Index v = 0; v < turned_m.rows(); ++v) {
    turned_m.row(v) = (pose * crumpled.mesh.rest_m.row(v).transpose()).transpose();
  }
  crumpled.energy.follow(turned_m);
  EXPECT_NEAR(crumpled.energy.value(crumpled.frame, {}, turned_m), 0.0, 1e-9);
  const Points3 flat_m = testing::make_template().vertices_m.matrix<3>();
  crumpled.energy.follow(flat_m);
  EXPECT_GT(crumpled.energy.value(crumpled.frame, {}, flat_m), 1.0);
}

TEST(Energy, IsInfiniteBehindTheCamera) {
  const Crumpled crumpled;
  const Points3 behind_m = -crumpled.vertices_m;
  EXPECT_TRUE(std::isinf(crumpled.energy.value(crumpled.frame, {}, behind_m)));
}

TEST(Loss, AnOutlierOfTukeysCountsNothingAndOneOfHubersLess) {
  double energy = 0.0;
  EXPECT_DOUBLE_EQ((Loss{3.0, true}.weight(9.1, energy)), 0.0);
  EXPECT_DOUBLE_EQ(energy, 3.0);
  energy = 0.0;
  EXPECT_DOUBLE_EQ((Loss{1.0, false}.weight(25.0, energy)), 0.2);
  EXPECT_DOUBLE_EQ(energy, 9.0);
}

}  // namespace
}  // namespace weft::collins_integrated
