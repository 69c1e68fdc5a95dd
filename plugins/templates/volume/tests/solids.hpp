// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>
#include <weft/data/matrix.hpp>
#include <weft/data/template.hpp>
#include <weft/geometry/types.hpp>

namespace weft::volume {

/// A triangle mesh; closed ones are counter-clockwise from outside.
struct TestMesh {
  Points3 vertices_m;
  Faces faces;

  /// Adds another mesh beside it.
  void add(const TestMesh& other) {
    const Eigen::Index own = vertices_m.rows(), own_faces = faces.rows();
    vertices_m.conservativeResize(own + other.vertices_m.rows(), 3);
    vertices_m.bottomRows(other.vertices_m.rows()) = other.vertices_m;
    faces.conservativeResize(own_faces + other.faces.rows(), 3);
    faces.bottomRows(other.faces.rows()) = other.faces.array() + static_cast<std::int32_t>(own);
  }
  void turn_inside_out() { faces.col(1).swap(faces.col(2)); }

  /// With what is read of a surface alone.
  Template as_template() const {
    Template templ;
    templ.vertices_m = make_array<double>(vertices_m);
    templ.faces = make_array<std::int32_t>(faces);
    return templ;
  }
};

/// A box about `centre_m`; its last two faces are the side of largest z.
inline TestMesh box_mesh(const Eigen::Vector3d& size_m,
                         const Eigen::Vector3d& centre_m = Eigen::Vector3d::Zero()) {
  TestMesh mesh{Points3(8, 3), Faces(12, 3)};
  for (int v = 0; v < 8; ++v) {
    mesh.vertices_m.row(v) =
        centre_m + size_m.cwiseProduct(Eigen::Vector3d(v % 2 - 0.5, v / 2 % 2 - 0.5, v / 4 - 0.5));
  }
  mesh.faces << 0, 2, 3, 0, 3, 1, 0, 1, 5, 0, 5, 4, 2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1,
      7, 5, 4, 5, 7, 4, 7, 6;
  return mesh;
}

/// Rings of vertices around the z axis as a closed surface: each ring is a radius and a height. The
/// last ring is joined to the first. Outside is to the right of the direction from ring to ring, as
/// seen with the radius to the right and z up.
inline TestMesh turned_mesh(const std::vector<Eigen::Vector2d>& profile_m, int slices) {
  const auto rings = static_cast<int>(profile_m.size());
  TestMesh mesh{Points3(rings * slices, 3), Faces(2 * rings * slices, 3)};
  Eigen::Index f = 0;
  for (int i = 0; i < rings; ++i) {
    for (int k = 0; k < slices; ++k) {
      const double turn = 2.0 * M_PI * k / slices;
      const Eigen::Vector2d& at = profile_m[static_cast<std::size_t>(i)];
      mesh.vertices_m.row(i * slices + k) << at.x() * std::cos(turn), at.x() * std::sin(turn),
          at.y();
      const int a = i * slices + k, b = i * slices + (k + 1) % slices;
      const int c = (i + 1) % rings * slices + (k + 1) % slices, d = (i + 1) % rings * slices + k;
      mesh.faces.row(f++) << a, b, c;
      mesh.faces.row(f++) << a, c, d;
    }
  }
  return mesh;
}

/// A hose about the z axis.
inline TestMesh hose_mesh(double outer_m, double inner_m, double length_m, int slices) {
  const double z_m = 0.5 * length_m;
  return turned_mesh({{outer_m, -z_m}, {outer_m, z_m}, {inner_m, z_m}, {inner_m, -z_m}}, slices);
}

/// A ball about the origin, with one vertex at each pole.
inline TestMesh ball_mesh(double radius_m, int stacks, int slices) {
  const int rings = stacks - 1, south = rings * slices, north = south + 1;
  TestMesh mesh{Points3(north + 1, 3), Faces(2 * rings * slices, 3)};
  Eigen::Index f = 0;
  for (int i = 0; i < rings; ++i) {
    const double up = M_PI * (i + 1) / stacks - 0.5 * M_PI;
    for (int k = 0; k < slices; ++k) {
      const double turn = 2.0 * M_PI * k / slices;
      const int a = i * slices + k, b = i * slices + (k + 1) % slices;
      mesh.vertices_m.row(a) << radius_m * std::cos(up) * std::cos(turn),
          radius_m * std::cos(up) * std::sin(turn), radius_m * std::sin(up);
      if (i == 0) mesh.faces.row(f++) << south, b, a;
      if (i + 1 == rings) {
        mesh.faces.row(f++) << a, b, north;
      } else {
        mesh.faces.row(f++) << a, b, b + slices;
        mesh.faces.row(f++) << a, b + slices, a + slices;
      }
    }
  }
  mesh.vertices_m.row(south) << 0.0, 0.0, -radius_m;
  mesh.vertices_m.row(north) << 0.0, 0.0, radius_m;
  return mesh;
}

}  // namespace weft::volume
