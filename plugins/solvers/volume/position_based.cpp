// SPDX-License-Identifier: Apache-2.0
#include "position_based.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>

namespace weft::volume {
namespace {

constexpr double kPull = 0.5, kLength = 0.3, kVolume = 0.5;  // shares that a sweep corrects
constexpr double kMomentum = 0.9;

Eigen::Vector3d at(const Points3& nodes_m, std::int32_t node) {
  return nodes_m.row(node).transpose();
}

void move(const SolidModel& body, const BodyPoint& point, const Eigen::Vector3d& by_m,
          Points3& nodes_m) {
  const auto& node = body.tetrahedra()[to_index(point.tetrahedron)].node;
  for (int a = 0; a < 4; ++a) {
    nodes_m.row(node[to_index(a)]) +=
        point.weights[a] / point.weights.squaredNorm() * by_m.transpose();
  }
}

}  // namespace

void PositionBased::prepare(const SolidModel& body) {
  body_ = &body;
  edges_.clear();
  for (const auto& [i, j] : body.couplings()) {
    edges_.push_back({i, j, (body.nodes_m().row(i) - body.nodes_m().row(j)).norm()});
  }
  volumes_m3_.clear();
  for (const Tetrahedron& each : body.tetrahedra()) {
    const Eigen::Vector3d origin = at(body.nodes_m(), each.node[0]);
    const Eigen::Vector3d a = at(body.nodes_m(), each.node[1]) - origin;
    const Eigen::Vector3d b = at(body.nodes_m(), each.node[2]) - origin;
    const Eigen::Vector3d c = at(body.nodes_m(), each.node[3]) - origin;
    volumes_m3_.push_back(a.dot(b.cross(c)) / 6.0);
  }
}

solvers::MinimiserResult PositionBased::run(const FrameData& frame, const Scales& scales,
                                            const solvers::MinimiserOptions& options,
                                            Points3& nodes_m) {
  solvers::MinimiserResult result;
  Points3 velocity_m = Points3::Zero(nodes_m.rows(), 3);
  while (result.iterations < options.max_iterations) {
    ++result.iterations;
    worked(static_cast<std::int64_t>(20 * volumes_m3_.size()));
    const Points3 before_m = nodes_m;
    nodes_m += kMomentum * velocity_m;
    pull(frame, scales, nodes_m);
    keep_lengths(nodes_m);
    keep_volumes(nodes_m);
    velocity_m = nodes_m - before_m;
    result.last_step_m =
        std::sqrt(velocity_m.squaredNorm() / static_cast<double>(velocity_m.rows()));
    if (!std::isfinite(result.last_step_m)) {
      result.stop = solvers::Stop::not_finite;
      return result;
    }
    if (result.last_step_m < options.tolerance_m) {
      result.stop = solvers::Stop::converged;
      return result;
    }
  }
  return result;
}

void PositionBased::pull(const FrameData& frame, const Scales& scales, Points3& nodes_m) const {
  for (const Observation& o : frame.observations) {
    const Eigen::Vector3d point_m = o.point.on(body_->tetrahedra(), nodes_m);
    const Eigen::Vector3d ray = unit_ray(frame.camera, o.seen_px);
    const Eigen::Vector3d off_m = point_m.dot(ray) * ray - point_m;
    const double off_px = off_m.norm() * frame.camera.fx / std::abs(point_m.z());
    double unused = 0.0;
    const double trust = scales.trust.weight(std::pow(o.white.xx * off_px, 2), unused);
    move(*body_, o.point, kPull * trust * off_m, nodes_m);
  }
  for (const KnownPlace& each : frame.known) {
    const Eigen::Vector3d off_m = each.centre_m - each.point.on(body_->tetrahedra(), nodes_m);
    const double beyond_m = off_m.norm() - each.radius_m;
    if (beyond_m > 0.0) move(*body_, each.point, beyond_m * off_m.normalized(), nodes_m);
  }
}

void PositionBased::keep_lengths(Points3& nodes_m) const {
  for (const DistanceConstraint& edge : edges_) {
    const Eigen::Vector3d along = at(nodes_m, edge.j) - at(nodes_m, edge.i);
    const double length_m = along.norm();
    if (!(length_m > 0.0)) continue;
    const Eigen::Vector3d by_m = 0.5 * kLength * (length_m - edge.rest_length_m) / length_m * along;
    nodes_m.row(edge.i) += by_m.transpose();
    nodes_m.row(edge.j) -= by_m.transpose();
  }
}

void PositionBased::keep_volumes(Points3& nodes_m) const {
  for (std::size_t e = 0; e < volumes_m3_.size(); ++e) {
    const auto& node = body_->tetrahedra()[e].node;
    const Eigen::Vector3d origin = at(nodes_m, node[0]);
    const Eigen::Vector3d a = at(nodes_m, node[1]) - origin, b = at(nodes_m, node[2]) - origin,
                          c = at(nodes_m, node[3]) - origin;
    Eigen::Matrix<double, 3, 4> slopes;
    slopes.col(1) = b.cross(c) / 6.0;
    slopes.col(2) = c.cross(a) / 6.0;
    slopes.col(3) = a.cross(b) / 6.0;
    slopes.col(0) = -slopes.rightCols<3>().rowwise().sum();
    const double squares = slopes.squaredNorm();
    if (!(squares > 0.0)) continue;
    const double grown_m3 = a.dot(slopes.col(1)) - volumes_m3_[e];
    for (std::size_t k = 0; k < 4; ++k) {
      nodes_m.row(node[k]) -=
          kVolume * grown_m3 / squares * slopes.col(static_cast<Eigen::Index>(k)).transpose();
    }
  }
}

}  // namespace weft::volume
