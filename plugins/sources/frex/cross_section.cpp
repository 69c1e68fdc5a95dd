// SPDX-License-Identifier: Apache-2.0
#include "cross_section.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <weft/core/index.hpp>
#include <weft/geometry/distance_constraints.hpp>
#include <weft/geometry/mesh_topology.hpp>

namespace weft::frex {
namespace {

constexpr double kStraight = 1e-4;   // mean squared sine between a normal and the plane of normals
constexpr double kUnrolls = 0.01;    // strain of an edge; vertices in files are rounded
constexpr double kSamePlace = 1e-6;  // share of the extent across

double integral(const std::function<double(double)>& f, double from, double to) {  // Simpson
  return (to - from) / 6.0 * (f(from) + 4.0 * f(0.5 * (from + to)) + f(to));
}

/// The direction to which all faces are parallel; nothing where there is none or more than one.
std::optional<Eigen::Vector3d> straight_direction(const RestSheet& sheet) {
  Eigen::Matrix3d normals = Eigen::Matrix3d::Zero();
  double weight = 0.0;
  for (Eigen::Index f = 0; f < sheet.faces.rows(); ++f) {
    const Eigen::Vector3d a = sheet.rest_m.row(sheet.faces(f, 0));
    const Eigen::Vector3d b = sheet.rest_m.row(sheet.faces(f, 1));
    const Eigen::Vector3d c = sheet.rest_m.row(sheet.faces(f, 2));
    const Eigen::Vector3d normal = (b - a).cross(c - a);
    if (normal.norm() <= 0.0) continue;
    normals += normal * normal.transpose() / normal.norm();
    weight += normal.norm();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> parts(normals / weight);
  const Eigen::Vector3d& spread = parts.eigenvalues();  // ascending
  if (!(spread[0] < kStraight) || !(spread[1] > kStraight)) return std::nullopt;
  return parts.eigenvectors().col(0);
}

Eigen::RowVector2d middle_of(const Points2& points) {
  return 0.5 * (points.colwise().minCoeff() + points.colwise().maxCoeff());
}

}  // namespace

std::optional<CrossSection> CrossSection::of(const RestSheet& sheet) {
  if (!sheet.is_unrolled) return std::nullopt;
  const auto straight = straight_direction(sheet);
  const auto topology = build_topology(sheet.faces, sheet.rest_m.rows());
  if (!straight || !topology) return std::nullopt;
  Points2 unrolled_m = sheet.flat_m();
  unrolled_m.rowwise() -= middle_of(unrolled_m);
  // The place along the straight direction is a linear function of the template point.
  const Eigen::Vector2d ruling = unrolled_m.colPivHouseholderQr().solve(
      sheet.rest_m * *straight -
      Eigen::VectorXd::Constant(sheet.rest_m.rows(), (sheet.rest_m * *straight).mean()));
  const double sign = ruling.dot(straight->head<2>()) < 0.0 ? -1.0 : 1.0;
  CrossSection section;
  section.ruling_rad_ = std::atan2(-sign * ruling.x(), sign * ruling.y());
  const Eigen::Vector2d across(std::cos(section.ruling_rad_), std::sin(section.ruling_rad_));
  const Eigen::Vector3d axis = sign * *straight;
  const Eigen::Vector3d away = (Eigen::Vector3d::UnitZ() - axis.z() * axis).normalized();
  const Eigen::VectorXd places_m = unrolled_m * across;
  std::vector<Eigen::Index> order(to_index(places_m.size()));
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(),
            [&](Eigen::Index i, Eigen::Index j) { return places_m[i] < places_m[j]; });
  const double same_m = kSamePlace * (places_m.maxCoeff() - places_m.minCoeff());
  for (const Eigen::Index v : order) {
    if (!section.along_m_.empty() && places_m[v] - section.along_m_.back() < same_m) continue;
    const Eigen::Vector3d point = sheet.rest_m.row(v);
    section.along_m_.push_back(places_m[v]);
    section.curve_m_.emplace_back(point.dot(axis.cross(away)), point.dot(away));
  }
  if (section.along_m_.size() < 2) return std::nullopt;
  const auto left = to_index(section.piece_at(0.0));
  const double middle_m = 0.5 * (section.curve_m_[left] + section.curve_m_[left + 1]).x();
  for (Eigen::Vector2d& knot : section.curve_m_) knot.x() -= middle_m;
  const auto edges = distance_constraints(topology->edges, sheet.rest_m);
  const Points3 again_m = section.rolled(unrolled_m, [](double) { return 0.0; });
  if (!edges || strain_statistics(*edges, again_m).max > kUnrolls) return std::nullopt;
  return section;
}

Eigen::Index CrossSection::piece_at(double place_m) const {
  const auto after = std::upper_bound(along_m_.begin(), along_m_.end(), place_m);
  return std::clamp<Eigen::Index>(after - along_m_.begin() - 1, 0,
                                  static_cast<Eigen::Index>(along_m_.size()) - 2);
}

Points3 CrossSection::rolled(const Points2& unrolled_m,
                             const std::function<double(double s_m)>& curvature_per_m) const {
  // Piece k reaches from knot k to the next one and is turned as a whole.
  const auto pieces = static_cast<Eigen::Index>(along_m_.size()) - 1;
  const Eigen::Index middle = piece_at(0.0);
  const auto at = [](Eigen::Index k) { return to_index(k); };
  std::vector<double> turn_rad(at(pieces));
  std::vector<Eigen::Vector2d> start_m(at(pieces));
  const auto turned = [&](Eigen::Index k, double share) -> Eigen::Vector2d {
    return Eigen::Rotation2Dd(turn_rad[at(k)]) * (share * (curve_m_[at(k + 1)] - curve_m_[at(k)]));
  };
  const auto centre_m = [&](Eigen::Index k) {
    return 0.5 * (along_m_[at(k)] + along_m_[at(k + 1)]);
  };
  turn_rad[at(middle)] = 0.0;
  start_m[at(middle)] = curve_m_[at(middle)];
  for (Eigen::Index k = middle + 1; k < pieces; ++k) {
    turn_rad[at(k)] = turn_rad[at(k - 1)] + integral(curvature_per_m, centre_m(k - 1), centre_m(k));
    start_m[at(k)] = start_m[at(k - 1)] + turned(k - 1, 1.0);
  }
  for (Eigen::Index k = middle - 1; k >= 0; --k) {
    turn_rad[at(k)] = turn_rad[at(k + 1)] + integral(curvature_per_m, centre_m(k + 1), centre_m(k));
    start_m[at(k)] = start_m[at(k + 1)] - turned(k, 1.0);
  }
  const Eigen::Vector2d across(std::cos(ruling_rad_), std::sin(ruling_rad_));
  const Eigen::Vector2d ruling(-across.y(), across.x());
  Points3 surface_m(unrolled_m.rows(), 3);
  for (Eigen::Index v = 0; v < unrolled_m.rows(); ++v) {
    const double place_m = unrolled_m.row(v).dot(across);
    const Eigen::Index k = piece_at(place_m);
    const double share = (place_m - along_m_[at(k)]) / (along_m_[at(k + 1)] - along_m_[at(k)]);
    const Eigen::Vector2d on_curve = start_m[at(k)] + turned(k, share);
    surface_m.row(v)
        << (on_curve.x() * across + unrolled_m.row(v).dot(ruling) * ruling).transpose(),
        on_curve.y();
  }
  return surface_m;
}

}  // namespace weft::frex
