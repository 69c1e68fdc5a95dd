// SPDX-License-Identifier: Apache-2.0
#include "shape_from_normals.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <weft/core/index.hpp>
#include <weft/core/statistics.hpp>

#include "common/smooth_spline.hpp"

namespace weft::chhatkuli_stable {
namespace {

constexpr int kRounds = 3;
constexpr double kHuber = 1.345;         // 95 % efficient for normal residuals
constexpr double kLeastScaleRad = 1e-3;  // least scale of the residuals: exact normals all count
                                         // alike
constexpr double kLeastCosine = 0.1;

/// The angle between each normal and the surface, [n] rad.
std::vector<double> angles_to_surface(const std::vector<NormalSample>& samples,
                                      const SplineDomain& domain,
                                      const solvers::SplineValues& control) {
  std::vector<double> angles_rad;
  angles_rad.reserve(samples.size());
  for (const NormalSample& sample : samples) {
    const double u = sample.place.x(), v = sample.place.y();
    const double depth = evaluate_site(domain, spline_site(domain, u, v), control)(0);
    const double along_u = evaluate_site(domain, spline_site(domain, u, v, 1, 0), control)(0);
    const double along_v = evaluate_site(domain, spline_site(domain, u, v, 0, 1), control)(0);
    const Eigen::Vector3d first = along_u * sample.ray + depth * sample.slope.col(0);
    const Eigen::Vector3d second = along_v * sample.ray + depth * sample.slope.col(1);
    const Eigen::Vector3d normal = second.cross(first);
    angles_rad.push_back(std::atan2(normal.cross(sample.normal).norm(), normal.dot(sample.normal)));
  }
  return angles_rad;
}

}  // namespace

void ShapeFromNormals::add_rows(const NormalSample& sample, double weight) {
  const SplineDomain& domain = equations_.domain();
  const double u = sample.place.x(), v = sample.place.y();
  const SplineSite value = spline_site(domain, u, v);
  const double towards = sample.normal.dot(sample.ray);
  for (int k = 0; k < 2; ++k) {
    SplineSite row = spline_site(domain, u, v, 1 - k, k);
    const double aside = sample.normal.dot(sample.slope.col(k));
    for (std::size_t a = 0; a < row.weights.size(); ++a) {
      row.weights[a] = towards * row.weights[a] + aside * value.weights[a];
    }
    equations_.add(row, Eigen::RowVectorXd::Zero(1), weight);
  }
}

Result<DepthShape> ShapeFromNormals::find(const std::vector<NormalSample>& samples,
                                          const SplineDomain& domain, double smoothing) {
  equations_.set_domain(domain);
  solvers::SplineValues control;
  std::vector<double> angles_rad(samples.size(), 0.0);
  double accepted_rad = kHuber * kLeastScaleRad;
  for (int round = 0; round <= kRounds; ++round) {
    equations_.clear(1);
    for (std::size_t g = 0; g < samples.size(); ++g) {
      // An error of the normal turns into a residual as long as the tangent, which is long where
      // the ray grazes the surface.
      const double cosine = std::abs(samples[g].normal.dot(samples[g].ray.normalized()));
      const double grazing = std::clamp(cosine, kLeastCosine, 1.0);
      const double huber = std::min(1.0, accepted_rad / std::max(angles_rad[g], 1e-300));
      add_rows(samples[g], grazing * grazing * huber);
    }
    auto solved = equations_.solve_homogeneous(smoothing);
    if (!solved) return solved.error();
    control = *std::move(solved);
    angles_rad = angles_to_surface(samples, domain, control);
    accepted_rad = kHuber * std::max(kSigmaPerMad * median(angles_rad), kLeastScaleRad);
  }
  DepthShape found;
  found.angle_rad = median(angles_rad);
  found.depth.resize(static_cast<Eigen::Index>(samples.size()));
  for (std::size_t g = 0; g < samples.size(); ++g) {
    const SplineSite site = spline_site(domain, samples[g].place.x(), samples[g].place.y());
    found.depth(static_cast<Eigen::Index>(g)) = evaluate_site(domain, site, control)(0);
  }
  if (!(found.depth.minCoeff() > 0.0)) {
    return no_result("the surface that has these normals is not in front of the camera");
  }
  return found;
}

}  // namespace weft::chhatkuli_stable
