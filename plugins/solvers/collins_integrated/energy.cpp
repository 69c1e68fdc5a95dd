// SPDX-License-Identifier: Apache-2.0
#include "energy.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>

namespace weft::collins_integrated {

double Loss::weight(double r2, double& energy) const {
  const double scale2 = scale * scale;
  if (redescends) {
    const double left = r2 < scale2 ? 1.0 - r2 / scale2 : 0.0;
    energy += scale2 / 3.0 * (1.0 - left * left * left);
    return left * left;
  }
  if (r2 <= scale2) {
    energy += r2;
    return 1.0;
  }
  const double r = std::sqrt(r2);
  energy += scale * (2.0 * r - scale);
  return scale / r;
}

void Energy::prepare(const MeshModel& mesh) {
  mesh_ = &mesh;
  rest_bends_rad_.resize(static_cast<Eigen::Index>(mesh.hinges.size()), 3);
  rest_bends_rad_.setZero();
}

void Energy::follow(const Points3& vertices_m) {
  for (std::size_t h = 0; h < mesh_->hinges.size(); ++h) {
    const Hinge& hinge = mesh_->hinges[h];
    if (hinge.rest_rad == 0.0) continue;
    worked_in_loop(static_cast<std::int64_t>(h), 10);
    rest_bends_rad_.row(static_cast<Eigen::Index>(h)) =
        hinge.rest_rad * normal_of(hinge, vertices_m).transpose();
  }
}

template <bool wants_derivatives>
double Energy::observed(const FrameData& frame, const std::vector<Observation>& observations,
                        const Loss& loss, const Points3& vertices_m, const Derivatives& to) const {
  const Pinhole camera = frame.camera;
  double energy = 0.0;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    worked_in_loop(static_cast<std::int64_t>(i), 10);
    const Observation& seen = observations[i];
    Eigen::Vector3d point = Eigen::Vector3d::Zero();
    for (Eigen::Index k = 0; k < 3; ++k) {
      point += seen.weights[k] * vertices_m.row(mesh_->faces(seen.face, k)).transpose();
    }
    if (!(point.z() > 0.0)) return std::numeric_limits<double>::infinity();
    const double near = 1.0 / point.z(), x = point.x() * near, y = point.y() * near;
    const Eigen::Vector2d off_px =
        Eigen::Vector2d(camera.fx * x + camera.cx, camera.fy * y + camera.cy) - seen.seen_px;
    const Eigen::Vector2d residual = seen.whitening_per_px * off_px;
    const double weight = loss.weight(residual.squaredNorm(), energy);
    if constexpr (wants_derivatives) {
      if (weight == 0.0) continue;
      Eigen::Matrix<double, 2, 3> slopes;  // derivative of the pixel, px/m
      slopes << camera.fx * near, 0.0, -camera.fx * near * x, 0.0, camera.fy * near,
          -camera.fy * near * y;
      slopes = (seen.whitening_per_px * slopes).eval();
      const Eigen::Matrix3d block = weight * slopes.transpose() * slopes;
      const Eigen::RowVector3d slope = weight * residual.transpose() * slopes;
      const auto& couplings = mesh_->face_couplings[to_index(seen.face)];
      for (Eigen::Index k = 0; k < 3; ++k) {
        const double own = seen.weights[k], next = seen.weights[(k + 1) % 3];
        const std::int32_t v = mesh_->faces(seen.face, k);
        to.gradient->row(v) += own * slope;
        to.matrix->diagonal[to_index(v)] += own * own * block;
        to.matrix->coupling[to_index(couplings[to_index(k)])] += own * next * block;
      }
    }
  }
  return energy;
}

template <bool wants_derivatives>
double Energy::stretched(double strain, const Points3& vertices_m, const Derivatives& to) const {
  double energy = 0.0;
  for (std::size_t e = 0; e < mesh_->edges.size(); ++e) {
    worked_in_loop(static_cast<std::int64_t>(e), 5);
    const Edge& edge = mesh_->edges[e];
    const Eigen::Vector3d offset_m = (vertices_m.row(edge.j) - vertices_m.row(edge.i)).transpose();
    const double length_m = offset_m.norm(), per_m = 1.0 / (strain * edge.rest_m);
    const double residual = (length_m - edge.rest_m) * per_m;
    energy += residual * residual;
    if constexpr (wants_derivatives) {
      if (!(length_m > 1e-6 * edge.rest_m)) continue;
      const Eigen::Vector3d unit = offset_m / length_m;
      const Eigen::RowVector3d slope = residual * per_m * unit.transpose();
      to.gradient->row(edge.j) += slope;
      to.gradient->row(edge.i) -= slope;
      // An edge that is too long resists motion to the side, too.
      const double aside = std::max(residual, 0.0) * per_m / length_m;
      const Eigen::Matrix3d along = unit * unit.transpose();
      const Eigen::Matrix3d block =
          per_m * per_m * along + aside * (Eigen::Matrix3d::Identity() - along);
      to.matrix->diagonal[to_index(edge.i)] += block;
      to.matrix->diagonal[to_index(edge.j)] += block;
      to.matrix->coupling[to_index(edge.coupling)] -= block;
    }
  }
  return energy;
}

template <bool wants_derivatives>
double Energy::bent(double bend_rad, const Points3& vertices_m, const Derivatives& to) const {
  double energy = 0.0;
  for (std::size_t h = 0; h < mesh_->hinges.size(); ++h) {
    worked_in_loop(static_cast<std::int64_t>(h), 8);
    const Hinge& hinge = mesh_->hinges[h];
    const double per_rad2 = hinge.weight / (3.0 * bend_rad * bend_rad);
    const Eigen::RowVector3d bend =
        bend_of(hinge, vertices_m).transpose() - rest_bends_rad_.row(static_cast<Eigen::Index>(h));
    energy += per_rad2 * bend.squaredNorm();
    if constexpr (wants_derivatives) {
      std::size_t pair = 0;
      for (std::size_t k = 0; k < 4; ++k) {
        const double own = per_rad2 * hinge.coefficient_per_m[k];
        to.gradient->row(hinge.vertex[k]) += own * bend;
        to.matrix->diagonal[to_index(hinge.vertex[k])].diagonal().array() +=
            own * hinge.coefficient_per_m[k];
        for (std::size_t l = k + 1; l < 4; ++l, ++pair) {
          to.matrix->coupling[to_index(hinge.coupling[pair])].diagonal().array() +=
              own * hinge.coefficient_per_m[l];
        }
      }
    }
  }
  return energy;
}

template <bool wants_derivatives>
double Energy::sum(const FrameData& frame, const Scales& scales, const Points3& vertices_m,
                   const Derivatives& to) const {
  constexpr bool d = wants_derivatives;
  double energy = observed<d>(frame, frame.matches, scales.loss, vertices_m, to) +
                  observed<d>(frame, frame.texture, scales.loss, vertices_m, to) +
                  stretched<d>(scales.strain, vertices_m, to) +
                  bent<d>(scales.bend_rad, vertices_m, to);
  if (!(scales.previous_m > 0.0) || frame.previous_m.rows() == 0) return energy;
  const double per_m2 = 1.0 / (scales.previous_m * scales.previous_m);
  energy += per_m2 * (vertices_m - frame.previous_m).squaredNorm();
  if constexpr (wants_derivatives) {
    *to.gradient += per_m2 * (vertices_m - frame.previous_m);
    for (Eigen::Matrix3d& block : to.matrix->diagonal) block.diagonal().array() += per_m2;
  }
  return energy;
}

double Energy::value(const FrameData& frame, const Scales& scales,
                     const Points3& vertices_m) const {
  return sum<false>(frame, scales, vertices_m, {});
}

double Energy::linearise(const FrameData& frame, const Scales& scales, const Points3& vertices_m,
                         Points3& gradient, solvers::BlockMatrix& matrix) const {
  gradient.setZero();
  matrix.set_zero();
  return sum<true>(frame, scales, vertices_m, {&gradient, &matrix});
}

}  // namespace weft::collins_integrated
