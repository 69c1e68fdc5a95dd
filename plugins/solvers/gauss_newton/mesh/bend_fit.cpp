// SPDX-License-Identifier: Apache-2.0
#include "bend_fit.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <weft/core/index.hpp>

namespace weft::gauss_newton {

BendFit::BendFit(const MeshModel& mesh, const Points3& normals) : mesh_(mesh), normals_(normals) {
  hinges_of_face_.assign(to_index(mesh.faces.rows()), {-1, -1, -1});
  for (std::size_t h = 0; h < mesh.hinges.size(); ++h) {
    for (const std::int32_t face : mesh.hinges[h].face) {
      auto& known = hinges_of_face_[to_index(face)];
      *std::find(known.begin(), known.end(), -1) = static_cast<std::int32_t>(h);
    }
  }
}

void BendFit::add_shares(const Arc& arc, const std::array<std::int32_t, 2>& around,
                         std::vector<HingeShare>& shares) {
  near_.clear();
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  for (const std::int32_t v : around) {
    for (const std::int32_t face : mesh_.faces_at[v]) {
      normal += normals_.row(face).transpose();
      for (const std::int32_t hinge : hinges_of_face_[to_index(face)]) {
        if (hinge >= 0) near_.push_back(hinge);
      }
    }
  }
  std::sort(near_.begin(), near_.end());
  near_.erase(std::unique(near_.begin(), near_.end()), near_.end());
  if (near_.empty()) return;
  normal.normalize();
  const Eigen::Vector3d chord = (mesh_.rest_m.row(arc.j) - mesh_.rest_m.row(arc.i)).transpose();
  const Eigen::Vector3d along = (chord - chord.dot(normal) * normal).normalized();
  const Eigen::Vector3d across = normal.cross(along);
  if (!along.allFinite() || !across.allFinite()) return;
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
  for (const std::int32_t h : near_) {
    const Eigen::Vector3d row = row_of(mesh_.hinges[to_index(h)], along, across);
    squares += row * row.transpose();
  }
  // Where few hinges leave a curvature open, it is the least one.
  squares.diagonal().array() += 1e-6 * squares.trace();
  const Eigen::Vector3d first = squares.inverse().col(0);
  for (const std::int32_t h : near_) {
    shares.push_back({h, first.dot(row_of(mesh_.hinges[to_index(h)], along, across))});
  }
}

/// The contributions of II_ss, II_st and II_tt to the angle of a hinge, s along and t across.
Eigen::Vector3d BendFit::row_of(const Hinge& hinge, const Eigen::Vector3d& along,
                                const Eigen::Vector3d& across) const {
  const auto at = [&](std::size_t k) -> Eigen::Vector3d {
    return mesh_.rest_m.row(hinge.vertex[k]).transpose();
  };
  const Eigen::Vector3d edge = at(1) - at(0), to_c = at(2) - at(0), to_d = at(3) - at(0);
  const double length = edge.norm();
  const Eigen::Vector3d unit = edge / length;
  const double y0 = to_c.dot(unit), y1 = to_d.dot(unit);
  const double h0 = (to_c - y0 * unit).norm(), h1 = (to_d - y1 * unit).norm();
  const double xx = 0.5 * (h0 + h1), xy = y1 - y0;
  const double yy = 0.5 * (y1 * (y1 - length) / h1 + y0 * (y0 - length) / h0);
  const Eigen::Vector2d y = Eigen::Vector2d(unit.dot(along), unit.dot(across)).normalized();
  const Eigen::Vector2d x(y.y(), -y.x());
  return {xx * x[0] * x[0] + xy * x[0] * y[0] + yy * y[0] * y[0],
          2.0 * xx * x[0] * x[1] + xy * (x[0] * y[1] + x[1] * y[0]) + 2.0 * yy * y[0] * y[1],
          xx * x[1] * x[1] + xy * x[1] * y[1] + yy * y[1] * y[1]};
}

}  // namespace weft::gauss_newton
