// SPDX-License-Identifier: Apache-2.0
#include "common/scene/lit_mesh.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <utility>
#include <weft/core/index.hpp>

namespace weft::scene {
namespace {

/// Normals at the vertices, weighted by the areas of the faces.
Points3 vertex_normals(const TriangleMesh& mesh) {
  Points3 normals = Points3::Zero(mesh.vertices_m.rows(), 3);
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    const auto corner = [&](int k) -> Eigen::RowVector3d {
      return mesh.vertices_m.row(mesh.faces(f, k));
    };
    const Eigen::RowVector3d normal = (corner(1) - corner(0)).cross(corner(2) - corner(0));
    for (int k = 0; k < 3; ++k) normals.row(mesh.faces(f, k)) += normal;
  }
  for (Eigen::Index v = 0; v < normals.rows(); ++v) normals.row(v).normalize();
  return normals;
}

}  // namespace

LitMesh::LitMesh(const Pinhole& camera, TriangleMesh mesh, const Light& light)
    : mesh_(std::move(mesh)), light_(light), normals_(vertex_normals(mesh_)) {
  Eigen::Matrix3d ray_of_pixel = Eigen::Matrix3d::Identity();
  ray_of_pixel.row(0) << 1.0 / camera.fx, 0.0, -camera.cx / camera.fx;
  ray_of_pixel.row(1) << 0.0, 1.0 / camera.fy, -camera.cy / camera.fy;
  maps_.reserve(to_index(mesh_.faces.rows()));
  for (Eigen::Index f = 0; f < mesh_.faces.rows(); ++f) {
    Eigen::Matrix3d corners;
    for (int k = 0; k < 3; ++k) corners.col(k) = mesh_.vertices_m.row(mesh_.faces(f, k));
    maps_.push_back({corners.inverse() * ray_of_pixel, corners.determinant() < 0.0});
  }
}

FacePoint LitMesh::at(std::int32_t face, double x_px, double y_px, Reach reach) const {
  const double margin = reach == Reach::of_a_hit ? 0.01 : 1.0;
  const Eigen::Vector3d over_depth = map(face).weights_of_pixel * Eigen::Vector3d(x_px, y_px, 1.0);
  FacePoint point{face, Eigen::Vector3d::Zero(), 1.0 / over_depth.sum()};
  point.weights = point.depth_m * over_depth;
  const bool is_near = point.weights.minCoeff() >= -margin &&
                       point.weights.maxCoeff() <= 1.0 + margin;  // false for NaN
  if (is_near) return point;
  for (double& weight : point.weights) weight = std::clamp(weight, -margin, 1.0 + margin);
  const double sum = point.weights.sum();
  constexpr double kLeast = 0.1;
  if (point.weights.allFinite() && sum > kLeast) {
    point.weights /= sum;
  } else {
    point.weights.setConstant(1.0 / 3.0);
  }
  point.depth_m = interpolated(mesh_.vertices_m, point).z();
  return point;
}

float LitMesh::brightness(const FacePoint& point) const {
  const Eigen::RowVector3d normal = interpolated(normals_, point);
  const double towards = normal.dot(light_.to_lamp.transpose());
  const double lambert = std::max(0.0, is_front(point.face) ? towards : -towards);
  return static_cast<float>(light_.ambient + (1.0 - light_.ambient) * lambert);
}

}  // namespace weft::scene
