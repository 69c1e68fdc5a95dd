// SPDX-License-Identifier: Apache-2.0
#include "energy.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <limits>
#include <weft/core/index.hpp>

#include "scene.hpp"

namespace weft::gauss_newton {
namespace {

constexpr std::uint64_t kShapeSeed = 11;

/// A bent surface that contradicts both the observations and the lengths at rest.
struct Bent {
  Scene scene = Scene::bent(0.2);
  MeshModel mesh;
  FrameData frame;
  Expectation expected;
  Points3 vertices_m;
  Energy energy;

  Bent() {
    std::cout << "seed " << kShapeSeed << "\n";
    if (!mesh.build(scene.templ, 0.0)) throw std::runtime_error("the template is no mesh");
    Rng rng(kShapeSeed);
    vertices_m = scene.truth_m;
    for (Eigen::Index k = 0; k < vertices_m.size(); ++k)
      vertices_m.data()[k] += 2e-3 * rng.normal();
    frame.camera = testing::pinhole(scene.camera);
    for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
      const std::size_t first = frame.observations.size();
      for (int n = 0; n < 2; ++n) {
        Observation seen;
        const double a = 0.5 * rng.uniform(), b = 0.5 * rng.uniform();
        seen.weights = {a, b, 1.0 - a - b};
        Eigen::Vector3d point = Eigen::Vector3d::Zero();
        for (Eigen::Index k = 0; k < 3; ++k) {
          point += seen.weights[static_cast<std::size_t>(k)] *
                   scene.truth_m.row(mesh.faces(f, k)).transpose();
        }
        const Eigen::Vector2d pixel = project(frame.camera, point);
        seen.seen_px = {pixel.x() + 3.0 * rng.normal(), pixel.y() + 3.0 * rng.normal()};
        seen.white = {0.5 + rng.uniform(), rng.uniform() - 0.5, 0.5 + rng.uniform()};
        frame.observations.push_back(seen);
      }
      frame.faces.push_back({static_cast<std::int32_t>(f), first, frame.observations.size()});
    }
    KnownSurfacePoint known;
    known.face = 5;
    for (std::size_t k = 0; k < 3; ++k) {
      known.vertices[k] = mesh.faces(5, static_cast<Eigen::Index>(k));
      known.weights[k] = 0.2 + 0.2 * static_cast<double>(k == 0 ? 2 : 1);
    }
    known.vertex = -1;
    known.centre_m = scene.truth_m.row(mesh.faces(5, 0)).transpose();
    known.radius_m = 0.001;
    frame.spheres.push_back(known);
    expected.previous_m = scene.truth_m;
    for (const Hinge& hinge : mesh.hinges) expected.bends_rad.push_back(hinge.rest_rad + 0.05);
    energy.prepare(mesh);
    energy.follow(vertices_m);
  }
};

TEST(Energy, ItsGradientIsThatOfFiniteDifferences) {
  for (const Trust trust : {Trust{1.0, false}, Trust{3.0, true}}) {
    Bent bent;
    Scales scales;
    scales.trust = trust;
    scales.known_m = 1e-3;
    scales.previous_m = 0.01;
    Points3 gradient(60, 3);
    BlockMatrix matrix;
    matrix.diagonal.resize(60);
    matrix.coupling.resize(bent.mesh.couplings.size());
    const double here =
        bent.energy.linearise(bent.frame, bent.expected, scales, bent.vertices_m, gradient, matrix);
    EXPECT_DOUBLE_EQ(here, bent.energy.value(bent.frame, bent.expected, scales, bent.vertices_m));
    constexpr double kStep_m = 1e-7;
    for (Eigen::Index k = 0; k < gradient.size(); ++k) {
      Points3 moved = bent.vertices_m;
      moved.data()[k] += kStep_m;
      const double beyond = bent.energy.value(bent.frame, bent.expected, scales, moved);
      moved.data()[k] -= 2.0 * kStep_m;
      const double before = bent.energy.value(bent.frame, bent.expected, scales, moved);
      const double half = 0.25 * (beyond - before) / kStep_m;
      EXPECT_NEAR(gradient.data()[k], half, 1e-4 * gradient.cwiseAbs().maxCoeff()) << k;
    }
  }
}

TEST(Energy, TheMatrixOfObservationsIsItsSecondDerivativeWhereTheyAreMet) {
  Bent bent;
  bent.frame.spheres.clear();
  for (const SeenFace& seen : bent.frame.faces) {
    Observation& met = bent.frame.observations[seen.first];
    const Eigen::Vector2d pixel = project(
        bent.frame.camera, bent.energy.surface_point_m(bent.vertices_m, seen.face, met.weights));
    for (std::size_t i = seen.first; i < seen.end; ++i) {
      bent.frame.observations[i].weights = met.weights;
      bent.frame.observations[i].seen_px = {pixel.x(), pixel.y()};
    }
  }
  Scales scales;
  scales.trust = {1e6, true};
  scales.strain = 1e6;
  scales.pair_strain = scales.bend_rad = 0.0;
  BlockMatrix matrix;
  matrix.diagonal.assign(60, Eigen::Matrix3d::Zero());
  matrix.coupling.assign(bent.mesh.couplings.size(), Eigen::Matrix3d::Zero());
  bent.energy.add_observations(bent.frame, scales, bent.vertices_m, matrix);
  Rng rng(kShapeSeed + 1);
  for (int trial = 0; trial < 5; ++trial) {
    Points3 along(60, 3);
    for (Eigen::Index k = 0; k < along.size(); ++k) along.data()[k] = rng.normal();
    double expected = 0.0;
    for (Eigen::Index v = 0; v < 60; ++v) {
      expected += along.row(v) * matrix.diagonal[to_index(v)] * along.row(v).transpose();
    }
    for (std::size_t c = 0; c < matrix.coupling.size(); ++c) {
      const auto [i, j] = bent.mesh.couplings[c];
      expected += 2.0 * along.row(i) * matrix.coupling[c] * along.row(j).transpose();
    }
    constexpr double kStep_m = 1e-5;
    const auto there = [&](double step_m) {
      return bent.energy.value(bent.frame, bent.expected, scales, bent.vertices_m + step_m * along);
    };
    const double found = 0.5 * (there(kStep_m) + there(-kStep_m)) / (kStep_m * kStep_m);
    EXPECT_NEAR(found, expected, 1e-4 * expected);
  }
}

TEST(Whitening, GivesEachDirectionOfItsCovarianceTheDeviationOne) {
  const auto white = Whitening::of_covariance(4.0, 1.2, 0.5);
  ASSERT_TRUE(white);
  Eigen::Matrix2d covariance, factor;
  covariance << 4.0, 1.2, 1.2, 0.5;
  factor << white->xx, 0.0, white->yx, white->yy;
  EXPECT_LT((factor * covariance * factor.transpose() - Eigen::Matrix2d::Identity()).norm(), 1e-12);
}

TEST(Whitening, IsNotThereForWhatIsNotPositiveDefinite) {
  const double nan = std::nan(""), infinite = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(Whitening::of_covariance(0.0, 0.0, 1.0));
  EXPECT_FALSE(Whitening::of_covariance(1.0, 1.0, 1.0));
  EXPECT_FALSE(Whitening::of_covariance(1.0, 2.0, 1.0));
  EXPECT_FALSE(Whitening::of_covariance(-1.0, 0.0, 1.0));
  EXPECT_FALSE(Whitening::of_covariance(nan, 0.0, 1.0));
  EXPECT_FALSE(Whitening::of_covariance(1.0, nan, 1.0));
  EXPECT_FALSE(Whitening::of_covariance(infinite, 0.0, 1.0));
}

TEST(Energy, IsInfiniteBehindTheCamera) {
  Bent bent;
  const Points3 behind = -bent.vertices_m;
  EXPECT_TRUE(std::isinf(bent.energy.value(bent.frame, bent.expected, {}, behind)));
}

TEST(Energy, AnOutlierCountsAtMostItsScaleSquared) {
  const Trust redescending{3.0, true}, huber{1.0, false};
  double energy = 0.0;
  EXPECT_LT(redescending.weight(1e8, energy), 1e-12);
  EXPECT_NEAR(energy, 9.0, 1e-5);
  energy = 0.0;
  EXPECT_DOUBLE_EQ(huber.weight(25.0, energy), 0.2);
  EXPECT_DOUBLE_EQ(energy, 9.0);
}

}  // namespace
}  // namespace weft::gauss_newton
