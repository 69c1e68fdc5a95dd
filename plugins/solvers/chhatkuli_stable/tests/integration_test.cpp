// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <string>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/statistics.hpp>

#include "../depth_from_gradients.hpp"
#include "../depth_from_normals.hpp"
#include "exact_surfaces.hpp"

namespace weft::chhatkuli_stable {
namespace {

constexpr Smoothing kLight{1e-9, 1e-12};
constexpr int kImageControl = 28;

SplineDomain domain(int control) { return {0.0, kWidthPx, 0.0, kHeightPx, control, control}; }

StableDepth by_gradients(const solvers::IsometricReading& reading, const Smoothing& smoothing) {
  DepthFromGradients solver;
  const auto found = solver.find(reading, domain(20), smoothing);
  EXPECT_TRUE(found) << found.error().message;
  return found ? *found : StableDepth{};
}

StableDepth by_normals(const solvers::IsometricReading& reading, const Smoothing& smoothing) {
  DepthFromNormals solver;
  const auto found = solver.find(reading, kImageControl, smoothing);
  EXPECT_TRUE(found) << found.error().message;
  return found ? *found : StableDepth{};
}

struct NamedSurface {
  std::string name;
  Surface surface;
};

std::vector<NamedSurface> surfaces() {
  return {{"plane", cylinder(0.0)},
          {"cylinder", cylinder(4.0)},
          {"hollow cylinder", cylinder(-4.0)},
          {"cone", cone(0.7)}};
}

TEST(CandidateNormals, OneOfThemIsTheNormalOfTheSurface) {
  for (const auto& [name, surface] : surfaces()) {
    const Eigen::Isometry3d pose = pose_of(0.6, 0.3);
    const auto reading = solvers::isometric_reading(read_exactly(surface, pose).places);
    ASSERT_EQ(reading.folded, 0) << name;
    for (std::size_t g = 0; g < reading.points.size(); ++g) {
      const Exact exact = surface(reading.places[g].place_px.x(), reading.places[g].place_px.y());
      const Eigen::Vector3d normal =
          pose.linear() * exact.derivative.col(1).cross(exact.derivative.col(0)).normalized();
      const auto [one, other] = candidate_normals(reading.places[g], reading.points[g]);
      EXPECT_LT(std::min((one - normal).norm(), (other - normal).norm()), 1e-5) << name << g;
      EXPECT_LT(one.dot(reading.points[g].ray), 0.0);
    }
  }
}

TEST(DepthFromGradients, FindsSurfacesOfWhichTheWarpIsExact) {
  for (const auto& [name, surface] : surfaces()) {
    const ExactReading exact = read_exactly(surface, pose_of(0.6, 0.3));
    const auto found = by_gradients(solvers::isometric_reading(exact.places), kLight);
    const double worst_m = (found.points_m - exact.truth_m).rowwise().norm().maxCoeff();
    std::cout << name << ": " << 1e6 * worst_m << " um at most, " << found.left_out
              << " left out\n";
    EXPECT_LT(worst_m, 1e-5) << name;
  }
}

TEST(DepthFromNormals, FindsSurfacesOfWhichTheWarpIsExact) {
  for (const auto& [name, surface] : surfaces()) {
    const ExactReading exact = read_exactly(surface, pose_of(0.6, 0.3));
    const auto found = by_normals(solvers::isometric_reading(exact.places), kLight);
    const double worst_m = (found.points_m - exact.truth_m).rowwise().norm().maxCoeff();
    std::cout << name << ": " << 1e6 * worst_m << " um at most\n";
    EXPECT_LT(worst_m, 1e-5) << name;
  }
}

TEST(StableDepth, DoesNotDependOnTheSignsThatTheWarpLeaves) {
  auto reading = solvers::isometric_reading(read_exactly(cone(0.7), pose_of(0.6, 0.2)).places);
  const Points3 gradients = by_gradients(reading, {}).points_m;
  const Points3 normals = by_normals(reading, {}).points_m;
  std::cout << "seed 21\n";
  Rng rng(21);
  for (solvers::IsometricPoint& point : reading.points) {
    if (rng.uniform(0.0, 1.0) < 0.5) point.gradient_mpp *= -1.0;
  }
  EXPECT_EQ((by_gradients(reading, {}).points_m - gradients).cwiseAbs().maxCoeff(), 0.0);
  EXPECT_LT((by_normals(reading, {}).points_m - normals).cwiseAbs().maxCoeff(), 1e-12);
}

/// Mean distance to the truth in m, after the best scale if `is_scaled`.
double error_m(const Points3& points_m, const Points3& truth_m, bool is_scaled) {
  const double scale =
      is_scaled ? points_m.cwiseProduct(truth_m).sum() / points_m.squaredNorm() : 1.0;
  return (scale * points_m - truth_m).rowwise().norm().mean();
}

// Eight times the focal length at eight times the distance: the same image but for perspective.
TEST(StableDepth, FromFarAwayTheShapeStaysAndTheDirectDepthGetsLost) {
  std::cout << "seed 22\n";
  Rng rng(22);
  double direct_m[2], gradients_m[2], normals_m[2];
  for (const int far : {0, 1}) {
    ExactReading exact = read_exactly(cylinder(4.0), pose_of(far == 0 ? 0.6 : 4.8, 0.3));
    disturb(exact.places, 0.01, rng);
    const auto reading = solvers::isometric_reading(exact.places);
    solvers::SmoothSpline direct;
    direct.set_domain(domain(12));
    ASSERT_TRUE(direct.fit(reading.places_px, reading.points_m, 1.0));
    direct_m[far] = error_m(direct.at(reading.places_px), exact.truth_m, true);
    gradients_m[far] = error_m(by_gradients(reading, {}).points_m, exact.truth_m, true);
    normals_m[far] = error_m(by_normals(reading, {}).points_m, exact.truth_m, true);
    std::cout << (far == 0 ? "near" : "far") << ": direct " << 1e3 * direct_m[far]
              << " mm, gradients " << 1e3 * gradients_m[far] << " mm, normals "
              << 1e3 * normals_m[far] << " mm\n";
  }
  EXPECT_GT(direct_m[1], 2.0 * direct_m[0]);
  EXPECT_LT(gradients_m[1], 0.7 * direct_m[1]);
  EXPECT_LT(normals_m[1], 0.5 * direct_m[1]);
}

TEST(DepthFromGradients, AFrontalPlaneHasTheDirectDepth) {
  const ExactReading exact = read_exactly(cylinder(0.0), [] {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translate(Eigen::Vector3d(0.0, 0.0, 800.0));
    return pose;
  }());
  const auto reading = solvers::isometric_reading(exact.places);
  const auto found = by_gradients(reading, {});
  EXPECT_TRUE(found.is_direct);
  EXPECT_EQ(found.points_m, reading.points_m);
}

TEST(ShapeFromNormals, OneNormalInTenThatIsWrongChangesLittle) {
  const ExactReading exact = read_exactly(cylinder(4.0), pose_of(0.6, 0.3));
  std::cout << "seed 23\n";
  Rng rng(23);
  std::vector<NormalSample> samples;
  Eigen::Matrix<double, 3, 2> slope = Eigen::Matrix<double, 3, 2>::Zero();
  slope.topRows<2>().setIdentity();
  for (const solvers::WarpPlace& place : exact.places) {
    const Exact at = cylinder(4.0)(place.place_px.x(), place.place_px.y());
    Eigen::Vector3d normal =
        pose_of(0.6, 0.3).linear() * at.derivative.col(1).cross(at.derivative.col(0)).normalized();
    if (rng.uniform(0.0, 1.0) < 0.1) {
      normal = (normal + 0.8 * Eigen::Vector3d::UnitX()).normalized();
    }
    samples.push_back({place.eta, place.eta.homogeneous(), slope, normal});
  }
  ShapeFromNormals solver;
  const auto found = solver.find(samples, {-0.4, 0.4, -0.4, 0.4, 16, 16}, 1e-3);
  ASSERT_TRUE(found);
  std::vector<double> ratios;
  for (Eigen::Index g = 0; g < found->depth.size(); ++g) {
    ratios.push_back(exact.truth_m(g, 2) / found->depth(g));
  }
  const double scale = median(ratios);
  EXPECT_LT((scale * found->depth - exact.truth_m.col(2)).cwiseAbs().mean(), 0.002);
}

}  // namespace
}  // namespace weft::chhatkuli_stable
