// SPDX-License-Identifier: Apache-2.0
#include "depth_from_normals.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <weft/core/index.hpp>

#include "common/patches.hpp"

namespace weft::chhatkuli_stable {
namespace {

/// The smallest square around the normalised image points, with these in its middle; it is the unit
/// square of the spline, so that its bending energy is computed once.
struct ImageSquare {
  Eigen::RowVector2d low;  ///< [2] normalised image point
  double side = 0.0;       ///< []

  explicit ImageSquare(const std::vector<solvers::WarpPlace>& places) {
    Eigen::Vector2d least = places.front().eta, most = least;
    for (const solvers::WarpPlace& place : places) {
      least = least.cwiseMin(place.eta), most = most.cwiseMax(place.eta);
    }
    side = (most - least).maxCoeff();
    low = 0.5 * ((least + most).transpose().array() - side);
  }
};

}  // namespace

std::pair<Eigen::Vector3d, Eigen::Vector3d> candidate_normals(
    const solvers::WarpPlace& place, const solvers::IsometricPoint& point) {
  const double length = std::sqrt(1.0 + place.eta.squaredNorm());
  Eigen::Matrix<double, 3, 2> sideways = Eigen::Matrix<double, 3, 2>::Zero();
  sideways.topRows<2>() = place.jacobian / length;
  sideways -= point.ray * (point.ray.transpose() * sideways).eval();
  const Eigen::Matrix<double, 3, 2> steep = point.ray * point.gradient_mpp.transpose();
  const Eigen::Matrix<double, 3, 2> one = point.distance_m * sideways + steep;
  const Eigen::Matrix<double, 3, 2> other = point.distance_m * sideways - steep;
  return {one.col(1).cross(one.col(0)).normalized(), other.col(1).cross(other.col(0)).normalized()};
}

Result<Points3> DepthFromNormals::reference_normals(const solvers::IsometricReading& reading,
                                                    const Points2View& places,
                                                    const SplineDomain& domain, double smoothing) {
  reference_.set_domain(domain);
  const double cells = (domain.nu - 3.0) * (domain.nv - 3.0);
  if (auto fitted = reference_.fit(places, reading.points_m, cells * smoothing); !fitted) {
    return fitted.error();
  }
  const Points3 along_u = reference_.at(places, 1, 0), along_v = reference_.at(places, 0, 1);
  Points3 normals(places.rows(), 3);
  for (Eigen::Index g = 0; g < places.rows(); ++g) {
    const Eigen::Vector3d first = along_u.row(g), second = along_v.row(g);
    normals.row(g) = second.cross(first).transpose();
  }
  return normals;
}

Result<StableDepth> DepthFromNormals::find(const solvers::IsometricReading& reading, int control,
                                           const Smoothing& smoothing) {
  const ImageSquare square(reading.places);
  const SplineDomain domain{0.0, 1.0, 0.0, 1.0, control, control};
  Points2 places(reading.places_px.rows(), 2);
  for (Eigen::Index g = 0; g < places.rows(); ++g) {
    places.row(g) = (reading.places[to_index(g)].eta.transpose() - square.low) / square.side;
  }
  const auto references = reference_normals(reading, places, domain, smoothing.reference);
  if (!references) return references.error();

  std::vector<NormalSample> samples;
  samples.reserve(reading.places.size());
  Eigen::Matrix<double, 3, 2> slope = Eigen::Matrix<double, 3, 2>::Zero();
  slope.topRows<2>() = square.side * Eigen::Matrix2d::Identity();
  for (std::size_t g = 0; g < reading.places.size(); ++g) {
    const auto row = static_cast<Eigen::Index>(g);
    const Eigen::Vector3d reference = references->row(row);
    const auto [one, other] = candidate_normals(reading.places[g], reading.points[g]);
    const Eigen::Vector3d normal = one.dot(reference) >= other.dot(reference) ? one : other;
    samples.push_back({places.row(row), reading.places[g].eta.homogeneous(), slope, normal});
  }
  const auto shape = shape_.find(samples, domain, smoothing.integration);
  if (!shape) return shape.error();

  StableDepth found;
  found.angle_rad = shape->angle_rad;
  const Eigen::VectorXd scales = solvers::medians_of_patches(
      solvers::patches_of(reading.places), reading.points_m.col(2).cwiseQuotient(shape->depth));
  found.points_m.resize(places.rows(), 3);
  for (Eigen::Index g = 0; g < places.rows(); ++g) {
    found.points_m.row(g) = scales(g) * shape->depth(g) * samples[to_index(g)].ray.transpose();
  }
  return found;
}

}  // namespace weft::chhatkuli_stable
