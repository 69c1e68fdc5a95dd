// SPDX-License-Identifier: Apache-2.0
#include "energy.hpp"

#include <gtest/gtest.h>

#include <iostream>

#include "scene.hpp"

namespace weft::gauss_newton {
namespace {

constexpr std::uint64_t kShapeSeed = 11;

/// A bent sheet that is neither as it is seen nor as long as at rest.
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
        seen.per_px = 0.5 + rng.uniform();
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
