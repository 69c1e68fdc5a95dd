// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>
#include <weft/core/index.hpp>
#include <weft/geometry/camera_model.hpp>

#include "common/scene/ray_caster.hpp"

namespace weft::scene {

/// A far lamp and light from all around: a matt surface with the normal n reflects
/// ambient + (1 - ambient) max(0, n . to_lamp) of its colour.
struct Light {
  Eigen::Vector3d to_lamp{0.0, 0.0, -1.0};  ///< [3] unit vector, camera frame
  double ambient = 0.4;                     ///< [] 0 to 1
};

/// Where a ray through a pixel meets the plane of a triangle.
struct FacePoint {
  std::int32_t face = -1;
  Eigen::Vector3d weights = Eigen::Vector3d::Zero();  ///< [3] barycentric, sum 1
  double depth_m = 0.0;                               ///< [] m, along the optical axis
};

/// A mesh in front of the camera in some light, with perspective-correct interpolation over its
/// triangles in closed form. A pixel has the ray d = K^-1 (x, y, 1), and M = [X0 X1 X2] are the
/// corners. The weights are z M^-1 d, z = 1 / sum(M^-1 d).
class LitMesh {
 public:
  /// How far beyond its triangle a point may lie, as a weight.
  enum class Reach { of_a_hit, of_a_neighbour };

  LitMesh(const Pinhole& camera, TriangleMesh mesh, const Light& light);

  const TriangleMesh& mesh() const { return mesh_; }

  /// True if the corners of the face are counter-clockwise in the camera's view.
  bool is_front(std::int32_t face) const { return map(face).is_front; }

  /// At the pixel (x,y). Weights are kept near the triangle, which matters where it is seen
  /// edge-on.
  FacePoint at(std::int32_t face, double x_px, double y_px, Reach reach) const;

  /// The values at the vertices, one row each, interpolated at a point.
  template <class Values>
  auto interpolated(const Values& values, const FacePoint& point) const {
    const auto row = [&](int k) { return values.row(mesh_.faces(point.face, k)); };
    const Eigen::Vector3d& w = point.weights;
    return (w[0] * row(0) + w[1] * row(1) + w[2] * row(2)).eval();
  }

  /// Light from the side of the mesh that the camera sees, 0 to 1.
  float brightness(const FacePoint& point) const;

 private:
  struct Map {
    Eigen::Matrix3d weights_of_pixel;  ///< over depth
    bool is_front;
  };
  const Map& map(std::int32_t face) const { return maps_[to_index(face)]; }

  TriangleMesh mesh_;
  Light light_;
  std::vector<Map> maps_;
  Points3 normals_;
};

}  // namespace weft::scene
