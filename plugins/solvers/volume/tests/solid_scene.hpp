// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>
#include <weft/core/rng.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/camera_model.hpp>
#include <weft/sdk/solver.hpp>

namespace weft::volume {

/// A block in cubes of six tetrahedra each (Kuhn's subdivision). Its surface has the outer nodes as
/// vertices; each vertex has its own place in a texture that only distinguishes it from others.
struct Block {
  std::array<int, 3> cubes{12, 5, 4};
  Eigen::Vector3d size_m{0.150, 0.060, 0.040};
  Points3 nodes_m, vertices_m;
  std::vector<std::array<std::int32_t, 4>> tetrahedra;
  std::vector<std::array<std::int32_t, 3>> faces;
  std::vector<std::int32_t> vertex_tetrahedron, node_of_vertex;

  explicit Block(std::array<int, 3> cubes_along = {12, 5, 4}) : cubes(cubes_along) {
    make_nodes();
    make_tetrahedra();
    make_surface();
  }

  Template templ() const {
    Template made;
    made.vertices_m = make_array<double>(vertices_m);
    made.nodes_m = make_array<double>(nodes_m);
    const auto vertex_count = vertices_m.rows();
    Points2 flat_px(vertex_count, 2);
    for (Eigen::Index v = 0; v < vertex_count; ++v) flat_px.row(v) << double(v), double(v * v % 97);
    made.flat_px = make_array<double>(flat_px);
    made.faces = Array<std::int32_t>({static_cast<std::int64_t>(faces.size()), 3});
    for (std::size_t f = 0; f < faces.size(); ++f) {
      std::copy_n(faces[f].data(), 3, made.faces.row(static_cast<std::int64_t>(f)));
    }
    made.m_per_px = Array<double>({2}, 1e-3);
    made.texture = Array<std::uint8_t>({100, 100}, 128);
    made.mask = Array<std::uint8_t>({100, 100}, 1);
    made.tetrahedra = Array<std::int32_t>({static_cast<std::int64_t>(tetrahedra.size()), 4});
    for (std::size_t e = 0; e < tetrahedra.size(); ++e) {
      std::copy_n(tetrahedra[e].data(), 4, made.tetrahedra.row(static_cast<std::int64_t>(e)));
    }
    made.vertex_tetrahedron = Array<std::int32_t>({vertex_count});
    made.vertex_barycentric = Array<double>({vertex_count, 4}, 0.0);
    for (Eigen::Index v = 0; v < vertex_count; ++v) {
      const std::int32_t e = vertex_tetrahedron[static_cast<std::size_t>(v)];
      made.vertex_tetrahedron(v) = e;
      const auto& corners = tetrahedra[static_cast<std::size_t>(e)];
      for (std::int64_t a = 0; a < 4; ++a) {
        const bool is_there =
            corners[static_cast<std::size_t>(a)] == node_of_vertex[static_cast<std::size_t>(v)];
        made.vertex_barycentric(v, a) = is_there ? 1.0 : 0.0;
      }
    }
    made.revision = 1;
    return made;
  }

 private:
  std::int32_t node(int i, int j, int k) const {
    return i + (cubes[0] + 1) * (j + (cubes[1] + 1) * k);
  }
  void make_nodes() {
    nodes_m.resize((cubes[0] + 1) * (cubes[1] + 1) * (cubes[2] + 1), 3);
    for (int k = 0; k <= cubes[2]; ++k) {
      for (int j = 0; j <= cubes[1]; ++j) {
        for (int i = 0; i <= cubes[0]; ++i) {
          nodes_m.row(node(i, j, k)) << size_m.x() * (double(i) / cubes[0] - 0.5),
              size_m.y() * (double(j) / cubes[1] - 0.5), size_m.z() * (double(k) / cubes[2] - 0.5);
        }
      }
    }
  }
  void make_tetrahedra() {
    std::array<int, 3> order{0, 1, 2};
    do {
      for (int k = 0; k < cubes[2]; ++k) {
        for (int j = 0; j < cubes[1]; ++j) {
          for (int i = 0; i < cubes[0]; ++i) add_tetrahedron({i, j, k}, order);
        }
      }
    } while (std::next_permutation(order.begin(), order.end()));
  }
  void add_tetrahedron(std::array<int, 3> corner, const std::array<int, 3>& order) {
    std::array<std::int32_t, 4> made{node(corner[0], corner[1], corner[2])};
    for (std::size_t step = 0; step < 3; ++step) {
      ++corner[static_cast<std::size_t>(order[step])];
      made[step + 1] = node(corner[0], corner[1], corner[2]);
    }
    Eigen::Matrix3d sides;
    for (int a = 0; a < 3; ++a) {
      sides.col(a) =
          (nodes_m.row(made[static_cast<std::size_t>(a) + 1]) - nodes_m.row(made[0])).transpose();
    }
    if (sides.determinant() < 0.0) std::swap(made[2], made[3]);
    tetrahedra.push_back(made);
  }
  /// The faces of tetrahedra that belong to one alone, outwards.
  void make_surface() {
    std::map<std::array<std::int32_t, 3>, std::array<std::int32_t, 4>> open;  // face, tetrahedron
    constexpr int kOpposite[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
    for (std::size_t e = 0; e < tetrahedra.size(); ++e) {
      for (const auto& corners : kOpposite) {
        std::array<std::int32_t, 3> face{};
        for (std::size_t c = 0; c < 3; ++c) {
          face[c] = tetrahedra[e][static_cast<std::size_t>(corners[c])];
        }
        std::array<std::int32_t, 3> key = face;
        std::sort(key.begin(), key.end());
        const auto found = open.find(key);
        if (found != open.end()) {
          open.erase(found);
        } else {
          open[key] = {face[0], face[1], face[2], static_cast<std::int32_t>(e)};
        }
      }
    }
    std::map<std::int32_t, std::int32_t> vertex_of;
    for (const auto& [key, at] : open) {
      std::array<std::int32_t, 3> face{};
      for (std::size_t c = 0; c < 3; ++c) {
        const auto [found, is_new] =
            vertex_of.try_emplace(at[c], static_cast<std::int32_t>(vertex_of.size()));
        if (is_new) {
          vertex_tetrahedron.push_back(at[3]);
          node_of_vertex.push_back(at[c]);
        }
        face[c] = found->second;
      }
      faces.push_back(face);
    }
    vertices_m.resize(static_cast<Eigen::Index>(node_of_vertex.size()), 3);
    for (std::size_t v = 0; v < node_of_vertex.size(); ++v) {
      vertices_m.row(static_cast<Eigen::Index>(v)) = nodes_m.row(node_of_vertex[v]);
    }
  }
};

/// Incompressible bending of a block along x about y (Rivlin, Large elastic deformations of
/// isotropic materials V, 1949): sections stay plane and det F = 1. The mean stretch over the
/// thickness is 1, as nothing pulls at the ends.
inline Eigen::Vector3d bent(const Eigen::Vector3d& at_m, double length_m, double thickness_m,
                            double angle_rad) {
  if (angle_rad == 0.0) return at_m;
  const double radius_m = length_m / angle_rad, turn_rad = at_m.x() / radius_m;
  const double r_m =
      std::copysign(1.0, radius_m) *
      std::sqrt(radius_m * radius_m + thickness_m * thickness_m / 12.0 - 2.0 * radius_m * at_m.z());
  return {r_m * std::sin(turn_rad), at_m.y(), radius_m - r_m * std::cos(turn_rad)};
}

/// A view of a deformed block: three of its sides are visible, 0.5 m before the camera.
struct SolidScene {
  Block block;
  Camera camera{820.0, 820.0, 319.5, 239.5, 640, 480};
  Eigen::Isometry3d camera_from_block = Eigen::Isometry3d::Identity();
  Points3 truth_m;                     ///< [V,3] m, camera frame
  Points3 truth_nodes_m;               ///< [K,3] m
  std::vector<std::uint8_t> is_front;  ///< [V] 1 for vertices of faces that turn to the camera

  template <class Map>
  explicit SolidScene(const Map& map, Block of = Block()) : block(std::move(of)) {
    camera_from_block.linear() = (Eigen::AngleAxisd(0.6, Eigen::Vector3d::UnitX()) *
                                  Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitY()))
                                     .toRotationMatrix() *
                                 Eigen::Vector3d(1.0, -1.0, -1.0).asDiagonal();
    camera_from_block.translation() << 0.01, -0.01, 0.5;
    truth_m = mapped(block.vertices_m, map);
    truth_nodes_m = mapped(block.nodes_m, map);
    is_front.assign(static_cast<std::size_t>(truth_m.rows()), 0);
    for (std::size_t f = 0; f < block.faces.size(); ++f) {
      if (!faces_camera(f)) continue;
      for (const std::int32_t v : block.faces[f]) is_front[static_cast<std::size_t>(v)] = 1;
    }
  }

  template <class Map>
  Points3 mapped(const Points3& rest_m, const Map& map) const {
    Points3 places_m(rest_m.rows(), 3);
    for (Eigen::Index i = 0; i < rest_m.rows(); ++i) {
      places_m.row(i) = (camera_from_block * map(rest_m.row(i).transpose())).transpose();
    }
    return places_m;
  }

  bool faces_camera(std::size_t f) const {
    const Eigen::Vector3d a = truth_m.row(block.faces[f][0]), b = truth_m.row(block.faces[f][1]),
                          c = truth_m.row(block.faces[f][2]);
    return (b - a).cross(c - a).dot(a) < 0.0;
  }

  /// Matches at random points of the visible faces, with normal noise and a share of mismatches
  /// anywhere in the image.
  template <class Map>
  Correspondences matches(int count, double noise_px, double wrong, std::uint64_t seed,
                          const Map& map) const {
    Rng rng(seed);
    std::vector<std::size_t> front;
    for (std::size_t f = 0; f < block.faces.size(); ++f) {
      if (faces_camera(f)) front.push_back(f);
    }
    Correspondences made;
    made.template_px = Array<double>({count, 2}, 0.0);
    made.image_px = Array<double>({count, 2});
    made.face = Array<std::int32_t>({count});
    made.barycentrics = Array<double>({count, 3});
    made.kept = Array<std::uint8_t>({count}, 1);
    made.score = Array<double>({count}, 1.0);
    const Pinhole pinhole{camera.fx, camera.fy, camera.cx, camera.cy};
    for (int i = 0; i < count; ++i) {
      const std::size_t f = front[static_cast<std::size_t>(rng.uniform(0.0, 1.0) *
                                                           static_cast<double>(front.size()))];
      Eigen::Vector3d weights(rng.uniform(0.0, 1.0), rng.uniform(0.0, 1.0), rng.uniform(0.0, 1.0));
      weights /= weights.sum();
      Eigen::Vector3d rest_m = Eigen::Vector3d::Zero();
      for (int k = 0; k < 3; ++k) {
        rest_m += weights[k] *
                  block.vertices_m.row(block.faces[f][static_cast<std::size_t>(k)]).transpose();
      }
      Eigen::Vector2d seen_px = project(pinhole, camera_from_block * map(rest_m));
      seen_px += noise_px * Eigen::Vector2d(rng.normal(), rng.normal());
      if (rng.uniform(0.0, 1.0) < wrong) {
        seen_px << rng.uniform(0.0, 640.0), rng.uniform(0.0, 480.0);
      }
      made.face(i) = static_cast<std::int32_t>(f);
      made.barycentrics.matrix<3>().row(i) = weights.transpose();
      made.image_px.matrix<2>().row(i) = seen_px.transpose();
    }
    return made;
  }
};

}  // namespace weft::volume
