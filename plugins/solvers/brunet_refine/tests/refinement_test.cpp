// SPDX-License-Identifier: Apache-2.0
#include "refinement.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <iostream>
#include <weft/core/stop_check.hpp>

#include "scene.hpp"

namespace weft::brunet_refine {
namespace {

std::vector<solvers::SeenPoint> points_of(const Scene& scene) {
  return *solvers::seen_points(scene.matches, scene.templ, 3);
}

/// The truth, larger by a factor as seen from the camera, with bumps.
Points3 ballooned(const Scene& scene, double factor, double bump_m) {
  Points3 start_m = factor * scene.truth_m;
  for (Eigen::Index v = 0; v < start_m.rows(); ++v) {
    start_m(v, 2) += v % 2 == 0 ? bump_m : -bump_m;
  }
  return start_m;
}

RefinedSurface refined(const Scene& scene, const Points3& start_m, const SurfaceOptions& surface,
                       const FitOptions& fit) {
  SplineRefinement refinement;
  EXPECT_TRUE(refinement.set_template(scene.templ, surface));
  return *refinement.refine(points_of(scene), scene.camera, start_m, fit);
}

double mean_error_m(const Scene& scene, const RefinedSurface& surface) {
  return (surface.vertices_m - scene.truth_m).rowwise().norm().mean();
}

TEST(SplineRefinement, EachStepLowersTheEnergy) {
  const Scene scene(0.25, 200, 0.5, 3);
  const RefinedSurface result = refined(scene, ballooned(scene, 1.05, 0.003), {}, {});
  ASSERT_GE(result.energy.size(), 4U);
  for (std::size_t k = 1; k < result.energy.size(); ++k) {
    EXPECT_LE(result.energy[k], result.energy[k - 1]) << k;
  }
  EXPECT_LT(result.energy.back(), 0.1 * result.energy.front());
  EXPECT_TRUE(result.converged);
}

TEST(SplineRefinement, ComesBackToTheTruthFromANearbyStart) {
  for (const double radius_m : {1e3, 0.25, -0.25}) {
    const Scene scene(radius_m, 300, 0.0, 4);
    const Points3 start_m = ballooned(scene, 1.03, 0.002);
    const RefinedSurface result = refined(scene, start_m, {}, {});
    const double start_error_m = (start_m - scene.truth_m).rowwise().norm().mean();
    std::cout << "radius " << radius_m << " m: " << 1e3 * start_error_m << " to "
              << 1e3 * mean_error_m(scene, result) << " mm in " << result.iterations
              << " iterations, metric " << result.metric_rms << "\n";
    EXPECT_LT(mean_error_m(scene, result), 0.001);
  }
}

TEST(SplineRefinement, WithoutItsPriorsItFollowsTheMatchesAndStretches) {
  const Scene scene(0.25, 300, 1.0, 5);
  const Points3 start_m = ballooned(scene, 1.05, 0.0);
  SurfaceOptions loose;
  loose.strain = 1.0;
  const RefinedSurface kept = refined(scene, start_m, {}, {});
  const RefinedSurface stretched = refined(scene, start_m, loose, {});
  EXPECT_LT(kept.metric_rms, 0.01);
  EXPECT_GT(stretched.metric_rms, 0.05);
  EXPECT_LT(mean_error_m(scene, kept), 0.3 * mean_error_m(scene, stretched));
}

TEST(SplineRefinement, SmoothingFlattens) {
  const Scene scene(0.15, 300, 0.0, 6);
  SurfaceOptions stiff;
  stiff.smoothing = 1e3;
  const RefinedSurface bent = refined(scene, scene.truth_m, {}, {});
  const RefinedSurface flat = refined(scene, scene.truth_m, stiff, {});
  const auto height_m = [](const RefinedSurface& surface) {
    const Points3 centred_m = surface.vertices_m.rowwise() - surface.vertices_m.colwise().mean();
    const Eigen::Matrix3d spread = centred_m.transpose() * centred_m / 60.0;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(spread);
    return std::sqrt(axes.eigenvalues()[0]);
  };
  EXPECT_GT(height_m(bent), 0.01);
  EXPECT_LT(height_m(flat), 0.2 * height_m(bent));
}

TEST(SplineRefinement, SaysWhenItDidNotConverge) {
  const Scene scene(0.25, 200, 0.5, 3);
  FitOptions short_of;
  short_of.max_iterations = 1;
  const RefinedSurface result = refined(scene, ballooned(scene, 1.05, 0.003), {}, short_of);
  EXPECT_FALSE(result.converged);
  EXPECT_EQ(result.iterations, 1);
}

TEST(SplineRefinement, AStartBehindTheCameraIsNoResult) {
  const Scene scene(0.25, 200, 0.5, 3);
  SplineRefinement refinement;
  ASSERT_TRUE(refinement.set_template(scene.templ, {}));
  const auto result = refinement.refine(points_of(scene), scene.camera, -scene.truth_m, {});
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, Errc::no_result);
}

TEST(SplineRefinement, StopsWhenAsked) {
  struct Asks {
    mutable int left;
  };
  const Scene scene(0.25, 200, 0.5, 3);
  const auto points = points_of(scene);
  const Points3 start_m = ballooned(scene, 1.05, 0.003);
  SplineRefinement refinement;
  ASSERT_TRUE(refinement.set_template(scene.templ, {}));
  for (const int asks : {0, 2, 5}) {  // the later ones come from within Ceres
    const Asks patience{asks};
    const StopCheck check(
        [](const void* whom) { return static_cast<const Asks*>(whom)->left-- <= 0; }, &patience);
    EXPECT_THROW((void)refinement.refine(points, scene.camera, start_m, {}), Stopped) << asks;
  }
}

}  // namespace
}  // namespace weft::brunet_refine
