// SPDX-License-Identifier: Apache-2.0
#include "elasticity.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cmath>
#include <vector>
#include <weft/core/rng.hpp>

#include "common/cholesky/damped_newton.hpp"
#include "energy.hpp"
#include "solid_scene.hpp"

namespace weft::volume {
namespace {

Eigen::Matrix3d random_matrix(Rng& rng, double size) {
  Eigen::Matrix3d made;
  for (double& each : made.reshaped()) each = rng.uniform(-size, size);
  return made;
}

Eigen::Matrix3d random_rotation(Rng& rng) {
  return Eigen::Quaterniond(rng.normal(), rng.normal(), rng.normal(), rng.normal())
      .normalized()
      .toRotationMatrix();
}

/// Mild, strong and inverted deformations.
std::vector<Eigen::Matrix3d> gradients() {
  Rng rng(7);
  std::vector<Eigen::Matrix3d> made;
  for (const double size : {0.02, 0.3, 0.8}) {
    for (int k = 0; k < 8; ++k) {
      made.emplace_back(random_rotation(rng) *
                        (Eigen::Matrix3d::Identity() + random_matrix(rng, size)));
    }
  }
  return made;
}

TEST(Elasticity, CostsNothingForARigidMotion) {
  Rng rng(3);
  const Material material = Material::of_poisson_ratio(0.49);
  for (int k = 0; k < 20; ++k) {
    EXPECT_LT(material.energy(random_rotation(rng)), 1e-24);
    EXPECT_LT(Linearised(material, random_rotation(rng)).half_stress().norm(), 1e-12);
  }
}

TEST(Elasticity, FindsTheNearestRotationAndTheStretches) {
  for (const Eigen::Matrix3d& gradient : gradients()) {
    const Stretch stretch = stretch_of(gradient);
    EXPECT_NEAR(stretch.rotation.determinant(), 1.0, 1e-12);
    EXPECT_LT((stretch.rotation * stretch.axes * stretch.stretches.asDiagonal() *
                   stretch.axes.transpose() -
               gradient)
                  .norm(),
              1e-7);
    EXPECT_NEAR(stretch.stretches.prod(), gradient.determinant(), 1e-7);
    EXPECT_LT((nearest_rotation(gradient) - stretch.rotation).norm(), 1e-12);
  }
}

TEST(Elasticity, HasTheStressThatDifferencesOfTheEnergyShow) {
  constexpr double kStep = 1e-6;
  const Material material = Material::of_poisson_ratio(0.4);
  for (const Eigen::Matrix3d& gradient : gradients()) {
    if (gradient.determinant() < 0.05) continue;  // R jumps where F loses a dimension
    const Eigen::Matrix3d half_stress = Linearised(material, gradient).half_stress();
    for (int k = 0; k < 9; ++k) {
      Eigen::Matrix3d more = gradient, less = gradient;
      more.reshaped()[k] += kStep;
      less.reshaped()[k] -= kStep;
      const double slope = (material.energy(more) - material.energy(less)) / (2.0 * kStep);
      EXPECT_NEAR(2.0 * half_stress.reshaped()[k], slope, 1e-6 * (1.0 + std::abs(slope)));
    }
  }
}

TEST(Elasticity, HasTheCurvatureThatDifferencesOfTheStressShowWhereTheVolumeIsKept) {
  constexpr double kStep = 1e-6;
  const Material soft{0.0};
  Rng rng(5);
  for (const Eigen::Matrix3d& gradient : gradients()) {
    const Stretch stretch = stretch_of(gradient);
    const Eigen::Vector3d& s = stretch.stretches;
    // Elsewhere the curvature is projected.
    if (std::min({s[0] + s[1], s[1] + s[2], s[2] + s[0]}) < 2.001) continue;
    const Linearised at(soft, gradient);
    const Eigen::Vector3d a = Eigen::Vector3d(rng.normal(), rng.normal(), rng.normal());
    const Eigen::Vector3d b = Eigen::Vector3d(rng.normal(), rng.normal(), rng.normal());
    const Eigen::Matrix3d block = at.half_curvature(at.slope(a), at.slope(b));
    for (int k = 0; k < 3; ++k) {
      const Eigen::Matrix3d off = kStep * Eigen::Vector3d::Unit(k) * b.transpose();
      const Eigen::Vector3d change = (Linearised(soft, gradient + off).half_stress() -
                                      Linearised(soft, gradient - off).half_stress()) *
                                     a / (2.0 * kStep);
      EXPECT_LT((block.col(k) - change).norm(), 1e-4 * (1.0 + block.norm()));
    }
  }
}

TEST(Elasticity, HasNoNegativeCurvature) {
  const Material material = Material::of_poisson_ratio(0.45);
  for (const Eigen::Matrix3d& gradient : gradients()) {
    const Linearised at(material, gradient);
    Eigen::Matrix<double, 9, 9> whole;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        whole.block<3, 3>(3 * i, 3 * j) = at.half_curvature(at.slope(Eigen::Vector3d::Unit(i)),
                                                            at.slope(Eigen::Vector3d::Unit(j)));
      }
    }
    EXPECT_LT((whole - whole.transpose()).norm(), 1e-9 * whole.norm());
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 9, 9>> eigen(whole);
    EXPECT_GT(eigen.eigenvalues()[0], -1e-9 * whole.norm());
  }
}

/// A block with one observation and one known point, away from rest.
struct Bent {
  Block block{{4, 2, 2}};
  SolidModel body;
  Energy energy;
  FrameData frame;
  Scales scales;
  Points3 nodes_m;

  Bent() {
    EXPECT_TRUE(body.build(block.templ()));
    energy.prepare(body);
    frame.camera = {800.0, 810.0, 320.0, 240.0};
    scales.trust = {3.0, true};
    scales.material = Material::of_poisson_ratio(0.4);
    scales.known_m = 1e-3;
    Rng rng(11);
    nodes_m = block.nodes_m;
    for (double& each : nodes_m.reshaped()) each += rng.uniform(-0.002, 0.002);
    nodes_m.col(2).array() += 0.5;
    frame.observations.push_back(
        {body.point_of(0, {0.2, 0.3, 0.5}), {300.0, 250.0}, solvers::Whitening{1.0, 0.3, 0.5}});
    frame.known.push_back({body.point_of(3, {0.6, 0.1, 0.3}), {0.01, 0.0, 0.52}, 0.002});
  }
};

TEST(VolumeEnergy, HasTheGradientThatDifferencesShow) {
  constexpr double kStep_m = 1e-6;  // a smaller one drowns in the rounding of a large energy
  Bent bent;
  Points3 gradient(bent.nodes_m.rows(), 3);
  solvers::BlockMatrix matrix;
  matrix.diagonal.resize(static_cast<std::size_t>(bent.nodes_m.rows()));
  matrix.coupling.resize(bent.body.couplings().size());
  const double energy =
      bent.energy.linearise(bent.frame, bent.scales, bent.nodes_m, gradient, matrix);
  EXPECT_NEAR(energy, bent.energy.value(bent.frame, bent.scales, bent.nodes_m), 1e-9 * energy);
  for (Eigen::Index i = 0; i < bent.nodes_m.size(); ++i) {
    Points3 more = bent.nodes_m, less = bent.nodes_m;
    more.data()[i] += kStep_m;
    less.data()[i] -= kStep_m;
    const double slope = (bent.energy.value(bent.frame, bent.scales, more) -
                          bent.energy.value(bent.frame, bent.scales, less)) /
                         (2.0 * kStep_m);
    EXPECT_NEAR(2.0 * gradient.data()[i], slope, 1e-3 * (1.0 + std::abs(slope)));
  }
}

TEST(VolumeEnergy, DoesNotChangeWhenTheBodyMovesRigidly) {
  Bent bent;
  const double before = bent.energy.mean_deformation(bent.scales.material, bent.nodes_m);
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(1.0, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  const Points3 moved_m =
      (bent.nodes_m * turn.transpose()).rowwise() + Eigen::RowVector3d(0.1, -0.2, 0.3);
  EXPECT_NEAR(bent.energy.mean_deformation(bent.scales.material, moved_m), before, 1e-12);
  const Points3 at_rest_m = bent.block.nodes_m * turn.transpose();
  EXPECT_LT(bent.energy.mean_deformation(bent.scales.material, at_rest_m), 1e-12);
}

TEST(VolumeEnergy, TurnsTetrahedraThatStartInsideOut) {
  Block block({4, 2, 2});
  SolidModel body;
  ASSERT_TRUE(body.build(block.templ()));
  Energy energy;
  energy.prepare(body);
  solvers::DampedNewton newton;
  ASSERT_TRUE(newton.prepare(body.nodes_m(), body.couplings()));
  Scales scales;
  scales.material = Material::of_poisson_ratio(0.3);
  Points3 nodes_m = body.nodes_m();
  nodes_m.col(2) *= -1.0;  // mirrored
  const auto inverted = [&] {
    int count = 0;
    for (const Tetrahedron& each : body.tetrahedra()) {
      count += each.gradient(nodes_m).determinant() > 0.0 ? 0 : 1;
    }
    return count;
  };
  ASSERT_EQ(inverted(), static_cast<int>(body.tetrahedra().size()));
  // Nothing holds a body that is mirrored exactly: it is between the rotations.
  Rng rng(1);
  for (double& each : nodes_m.reshaped()) each += rng.uniform(-1e-3, 1e-3);
  const FrameData nothing_seen;
  newton.run(
      {60, 1e-9},
      [&](int, const Points3& at_m, Points3& gradient, solvers::BlockMatrix& matrix) {
        return energy.linearise(nothing_seen, scales, at_m, gradient, matrix);
      },
      [&](const Points3& at_m) { return energy.value(nothing_seen, scales, at_m); }, nodes_m);
  EXPECT_EQ(inverted(), 0);
}

}  // namespace
}  // namespace weft::volume
