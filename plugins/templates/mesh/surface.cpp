// SPDX-License-Identifier: Apache-2.0
#include "surface.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>
#include <weft/core/index.hpp>
#include <weft/geometry/mesh_validation.hpp>

namespace weft::mesh {
namespace {

using Point = std::array<double, 3>;
using Triple = std::array<std::int32_t, 3>;
using Key = std::tuple<std::int32_t, double, double>;  // place, texture coordinates

/// For the corners of each face, the first of the file's positions at the same place.
std::vector<Triple> points_of(const MeshFile& file) {
  std::map<Point, std::int32_t> first_at;
  std::vector<std::int32_t> first;
  for (const Eigen::Vector3d& p : file.positions) {
    const auto number = static_cast<std::int32_t>(first.size());
    first.push_back(first_at.try_emplace({p.x(), p.y(), p.z()}, number).first->second);
  }
  std::vector<Triple> corners;
  for (const MeshFile::Face& face : file.faces) {
    Triple& triple = corners.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      triple[k] = first[to_index(face.corners[k].position)];
    }
  }
  return corners;
}

Result<void> check_manifold(const MeshFile& file, const std::vector<Triple>& points) {
  std::map<std::pair<std::int32_t, std::int32_t>, int> faces_at;
  std::set<Triple> seen;
  for (std::size_t f = 0; f < points.size(); ++f) {
    Triple sorted = points[f];
    std::sort(sorted.begin(), sorted.end());
    if (sorted[0] == sorted[1] || sorted[1] == sorted[2]) {
      return file.mistake(file.faces[f], "has two corners at the same place: remove it");
    }
    if (!seen.insert(sorted).second) {
      return file.mistake(file.faces[f], "has the corners of an earlier one: remove one of them");
    }
    for (std::size_t k = 0; k < 3; ++k) {
      const auto ends = std::minmax(points[f][k], points[f][(k + 1) % 3]);
      if (++faces_at[ends] < 3) continue;
      return file.mistake(file.faces[f],
                          "is the third at one edge: a surface has at most two there; remove what "
                          "branches off");
    }
  }
  return {};
}

int count_parts(const std::vector<Triple>& points) {
  std::map<std::int32_t, std::int32_t> up;
  const auto root = [&](std::int32_t i) {
    while (up.at(i) != i) i = up.at(i);
    return i;
  };
  for (const Triple& triple : points) {
    for (const std::int32_t point : triple) up.try_emplace(point, point);
  }
  auto parts = static_cast<int>(up.size());
  for (const Triple& triple : points) {
    for (std::size_t k = 1; k < 3; ++k) {
      const auto [low, high] = std::minmax({root(triple[0]), root(triple[k])});
      if (low == high) continue;
      up[high] = low;
      --parts;
    }
  }
  return parts;
}

/// Whether triangles overlap by more than `slack`, by separating axes: no side of either has the
/// other one beyond it.
bool overlap(const std::array<Eigen::Vector2d, 3>& a, const std::array<Eigen::Vector2d, 3>& b,
             double slack) {
  for (const auto* triangle : {&a, &b}) {
    const auto& other = triangle == &a ? b : a;
    for (std::size_t k = 0; k < 3; ++k) {
      const Eigen::Vector2d side = (*triangle)[(k + 1) % 3] - (*triangle)[k];
      // Away from the inside, where corners are clockwise in u and v.
      const Eigen::Vector2d outwards = Eigen::Vector2d(-side.y(), side.x()).normalized();
      double least = INFINITY;
      for (const Eigen::Vector2d& corner : other) {
        least = std::min(least, outwards.dot(corner - (*triangle)[k]));
      }
      if (least >= -slack) return false;
    }
  }
  return true;
}

std::array<Eigen::Vector2d, 3> corners_of(const Points2& flat_px, const Faces& faces,
                                          Eigen::Index f) {
  return {flat_px.row(faces(f, 0)), flat_px.row(faces(f, 1)), flat_px.row(faces(f, 2))};
}

Result<void> check_areas(const MeshFile& file, const Surface& surface) {
  const double least = smallest_area(surface.vertices);
  for (Eigen::Index f = 0; f < surface.faces.rows(); ++f) {
    if (face_area(surface.vertices, surface.faces, f) > least) continue;
    return file.mistake(file.faces[to_index(f)],
                        "has no area: remove it or move its corners apart");
  }
  return {};
}

}  // namespace

Result<Surface> weld(const MeshFile& file) {
  const std::vector<Triple> points = points_of(file);
  if (auto checked = check_manifold(file, points); !checked) return checked.error();
  const auto key_of = [&](std::size_t f, std::size_t k) {
    const std::int32_t texture = file.faces[f].corners[k].texture;
    Eigen::Vector2d uv = Eigen::Vector2d::Zero();
    if (texture >= 0) uv = file.texture_uv[to_index(texture)];
    return Key{points[f][k], uv.x(), uv.y()};
  };
  std::map<Key, std::int32_t> number_of;  // in the file's order of positions
  for (std::size_t f = 0; f < points.size(); ++f) {
    for (std::size_t k = 0; k < 3; ++k) number_of.emplace(key_of(f, k), 0);
  }
  const auto count = static_cast<Eigen::Index>(number_of.size());
  Surface surface{Points3(count, 3), Points2(count, 2), {}, count_parts(points)};
  std::int32_t next = 0;
  for (auto& [key, number] : number_of) {
    number = next++;
    const auto& [point, u, v] = key;
    surface.vertices.row(number) = file.positions[to_index(point)];
    surface.texture.row(number) << u, v;
  }
  surface.faces.resize(static_cast<Eigen::Index>(points.size()), 3);
  for (std::size_t f = 0; f < points.size(); ++f) {
    for (std::size_t k = 0; k < 3; ++k) {
      surface.faces(static_cast<Eigen::Index>(f), static_cast<Eigen::Index>(k)) =
          number_of.at(key_of(f, k));
    }
  }
  if (auto checked = check_areas(file, surface); !checked) return checked.error();
  return surface;
}

Result<void> orient(const MeshFile& file, const Points2& flat_px, Faces& faces) {
  const double least = smallest_area(flat_px);
  Eigen::Index clockwise = 0;
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    const double area = signed_area_px2(flat_px, faces, f);
    clockwise += area > 0.0 ? 1 : 0;
    if (std::abs(area) > least) continue;
    return file.mistake(file.faces[to_index(f)],
                        "has no area in the texture: unfold its texture coordinates");
  }
  const bool is_turned = 2 * clockwise > faces.rows();
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    if ((signed_area_px2(flat_px, faces, f) > 0.0) == is_turned) continue;
    return file.mistake(file.faces[to_index(f)],
                        "is flipped in the texture against most others: turn its texture "
                        "coordinates, or swap two of its corners");
  }
  if (is_turned) faces.col(1).swap(faces.col(2));
  return {};
}

Result<void> check_overlap(const MeshFile& file, const Points2& flat_px, const Faces& faces) {
  constexpr double kSlack_px = 0.01;
  const Eigen::RowVector2d low = flat_px.colwise().minCoeff();
  const Eigen::RowVector2d extent = flat_px.colwise().maxCoeff() - low;
  const double cell_px = std::max(std::sqrt(extent.prod() / static_cast<double>(faces.rows())),
                                  extent.maxCoeff() / 2000.0);
  std::map<std::pair<int, int>, std::vector<Eigen::Index>> faces_in;
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    const auto corners = corners_of(flat_px, faces, f);
    const auto cell_of = [&](const Eigen::Vector2d& p) -> Eigen::Vector2i {
      return ((p.transpose() - low) / cell_px).array().floor().cast<int>();
    };
    const Eigen::Vector2i first = cell_of(corners[0].cwiseMin(corners[1]).cwiseMin(corners[2]));
    const Eigen::Vector2i last = cell_of(corners[0].cwiseMax(corners[1]).cwiseMax(corners[2]));
    for (int j = first.y(); j <= last.y(); ++j) {
      for (int i = first.x(); i <= last.x(); ++i) {
        auto& here = faces_in[{j, i}];
        for (const Eigen::Index other : here) {
          if (!overlap(corners, corners_of(flat_px, faces, other), kSlack_px)) continue;
          const auto& earlier = file.faces[to_index(other)];
          return file.mistake(
              file.faces[to_index(f)],
              "overlaps that of " +
                  (earlier.line > 0 ? "line " + std::to_string(earlier.line)
                                    : "number " + std::to_string(earlier.count)) +
                  " in the texture: give each part of the surface its own part of the picture");
        }
        here.push_back(f);
      }
    }
  }
  return {};
}

}  // namespace weft::mesh
