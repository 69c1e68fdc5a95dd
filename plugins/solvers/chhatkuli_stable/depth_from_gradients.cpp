// SPDX-License-Identifier: Apache-2.0
#include "depth_from_gradients.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/statistics.hpp>

#include "common/patches.hpp"

namespace weft::chhatkuli_stable {
namespace {

constexpr double kLeastSlope = 1e-3;  // below, the direction of the gradient is noise

/// The median of |grad(theta)| by length on the template: the cosine of the angle between the ray
/// and the steepest tangent.
double usual_slope(const solvers::IsometricReading& reading) {
  std::vector<double> slopes;
  slopes.reserve(reading.points.size());
  for (std::size_t g = 0; g < reading.points.size(); ++g) {
    const Eigen::Vector2d& gradient = reading.points[g].gradient_mpp;
    const Eigen::Matrix2d inverse = reading.places[g].metric.inverse();
    slopes.push_back(std::sqrt(gradient.dot(inverse * gradient)));
  }
  return median_in_place(slopes);
}

/// True where each gradient [n,2] is about along its reference: the cosine of the angle between
/// both is at most three standard deviations below the usual one.
std::vector<bool> are_consistent(const Points2View& gradients, const Points2View& references) {
  std::vector<double> cosines;
  cosines.reserve(to_index(gradients.rows()));
  for (Eigen::Index g = 0; g < gradients.rows(); ++g) {
    const double lengths = gradients.row(g).norm() * references.row(g).norm();
    const double product = std::abs(gradients.row(g).dot(references.row(g)));
    cosines.push_back(lengths > 0.0 ? product / lengths : 1.0);
  }
  const double least = median(cosines) - 3.0 * standard_deviation(cosines);
  std::vector<bool> consistent;
  consistent.reserve(cosines.size());
  for (const double cosine : cosines) consistent.push_back(!(cosine < least));
  return consistent;
}

/// The gradients with the sign of their references, which the larger component determines.
Points2 signed_gradients(const solvers::IsometricReading& reading, const Points2View& references) {
  Points2 gradients(references.rows(), 2);
  for (Eigen::Index g = 0; g < gradients.rows(); ++g) {
    const Eigen::Vector2d& gradient = reading.points[to_index(g)].gradient_mpp;
    const Eigen::Index larger = std::abs(gradient.x()) >= std::abs(gradient.y()) ? 0 : 1;
    const bool agrees = gradient(larger) * references(g, larger) >= 0.0;
    gradients.row(g) = (agrees ? 1.0 : -1.0) * gradient.transpose();
  }
  return gradients;
}

Eigen::VectorXd distances_of(const solvers::IsometricReading& reading) {
  Eigen::VectorXd distances_m(reading.points_m.rows());
  for (Eigen::Index g = 0; g < distances_m.size(); ++g) {
    distances_m(g) = reading.points[to_index(g)].distance_m;
  }
  return distances_m;
}

}  // namespace

Result<StableDepth> DepthFromGradients::find(const solvers::IsometricReading& reading,
                                             const SplineDomain& domain,
                                             const Smoothing& smoothing) {
  StableDepth found;
  if (usual_slope(reading) < kLeastSlope) {
    found.points_m = reading.points_m;
    found.is_direct = true;
    return found;
  }
  reference_.set_domain(domain);
  equations_.set_domain(domain);
  const Points2& places_px = reading.places_px;
  const double cells = (domain.nu - 3.0) * (domain.nv - 3.0);
  if (auto fitted = reference_.fit(places_px, distances_of(reading), cells * smoothing.reference);
      !fitted) {
    return fitted.error();
  }
  Points2 references(places_px.rows(), 2);
  references << reference_.at(places_px, 1, 0), reference_.at(places_px, 0, 1);
  const Points2 gradients = signed_gradients(reading, references);
  const std::vector<bool> is_used = are_consistent(gradients, references);
  const auto integrated = solvers::integrate_gradients(equations_, places_px, gradients, is_used,
                                                       smoothing.integration);
  if (!integrated) return integrated.error();
  const Eigen::VectorXd more_m = reference_.at(places_px) - *integrated;
  const Eigen::VectorXd distances_m =
      *integrated + solvers::medians_of_patches(solvers::patches_of(reading.places), more_m);
  found.left_out = static_cast<int>(std::count(is_used.begin(), is_used.end(), false));
  found.points_m.resize(distances_m.size(), 3);
  for (Eigen::Index g = 0; g < distances_m.size(); ++g) {
    found.points_m.row(g) = distances_m(g) * reading.points[to_index(g)].ray.transpose();
  }
  return found;
}

}  // namespace weft::chhatkuli_stable
