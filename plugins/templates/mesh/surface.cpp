// SPDX-License-Identifier: Apache-2.0
#include "surface.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>
#include <weft/core/index.hpp>
#include <weft/geometry/mesh_validation.hpp>

#include "coincidence.hpp"

namespace weft::mesh {
namespace {

using Triple = std::array<std::int32_t, 3>;

Result<void> check_manifold(const MeshFile& file, const std::vector<Triple>& points) {
  std::map<std::pair<std::int32_t, std::int32_t>, int> faces_at;
  std::set<Triple> seen;
  for (std::size_t f = 0; f < points.size(); ++f) {
    Triple sorted = points[f];
    std::sort(sorted.begin(), sorted.end());
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

/// True if triangles overlap by more than `slack`, by separating axes: no side of either has the
/// other triangle completely beyond it.
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

/// How many faces share no edge with another one.
std::size_t count_isolated(const std::vector<Triple>& corners) {
  std::map<std::pair<std::int32_t, std::int32_t>, int> faces_at;
  const auto edge = [](const Triple& triple, std::size_t k) {
    return std::pair<std::int32_t, std::int32_t>(std::minmax(triple[k], triple[(k + 1) % 3]));
  };
  for (const Triple& triple : corners) {
    for (std::size_t k = 0; k < 3; ++k) ++faces_at[edge(triple, k)];
  }
  return to_index(std::count_if(corners.begin(), corners.end(), [&](const Triple& triple) {
    return faces_at[edge(triple, 0)] + faces_at[edge(triple, 1)] + faces_at[edge(triple, 2)] == 3;
  }));
}

/// Faces that each stand alone are no surface: nothing would hold them together.
Result<void> check_connected(const MeshFile& file, const std::vector<Triple>& points,
                             const std::vector<Triple>& corners) {
  constexpr std::size_t kFewest = 3;  // two triangles are parts that do not touch
  const std::size_t isolated = count_isolated(corners);
  if (corners.size() < kFewest || 2 * isolated <= corners.size()) return {};
  const bool by_texture = 2 * count_isolated(points) <= points.size();
  return Error{
      Errc::invalid_data,
      file.path + ": " + std::to_string(isolated) + " of " + std::to_string(corners.size()) +
          " faces share no edge with another one: " +
          (by_texture
               ? "each has its own piece of the image; unwrap the mesh into few connected pieces"
               : "their corners are not joined; merge vertices by distance in the program "
                 "that made the mesh (Blender: Merge by Distance; MeshLab: Merge Close "
                 "Vertices)") +
          ", and export it again"};
}

/// The faces' corners by number in `first`, which has those of the faces one after another.
std::vector<Triple> triples_of(const std::vector<std::int32_t>& first) {
  std::vector<Triple> triples(first.size() / 3);
  for (std::size_t i = 0; i < first.size(); ++i) triples[i / 3][i % 3] = first[i];
  return triples;
}

std::vector<Triple> points_of(const MeshFile& file, const std::vector<std::int32_t>& first) {
  std::vector<Triple> points;
  for (const MeshFile::Face& face : file.faces) {
    Triple& triple = points.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) triple[k] = first[to_index(face.corners[k].position)];
  }
  return points;
}

}  // namespace

Result<Surface> weld(MeshFile& file) {
  const std::vector<std::int32_t> first_position = first_positions(file);
  const std::size_t given = file.faces.size();
  if (const auto removed = remove_faces_without_area(file, first_position); removed > 0) {
    if (file.faces.empty()) {
      return Error{Errc::invalid_data, file.path + ": none of the " + std::to_string(given) +
                                           " faces has an area: export the mesh again"};
    }
    file.notes.push_back(std::to_string(removed) + " of " + std::to_string(given) +
                         " faces have no area and are omitted");
  }
  const std::vector<Triple> points = points_of(file, first_position);
  if (auto checked = check_manifold(file, points); !checked) return checked.error();
  const std::vector<Triple> corners = triples_of(first_corners(file, first_position));
  if (auto checked = check_connected(file, points, corners); !checked) return checked.error();
  using Key = std::tuple<std::int32_t, double, double, std::int32_t>;  // point, texture, corner
  std::vector<Key> firsts;
  for (std::size_t f = 0; f < corners.size(); ++f) {
    for (std::size_t k = 0; k < 3; ++k) {
      const auto own = static_cast<std::int32_t>(3 * f + k);
      if (corners[f][k] != own) continue;
      const std::int32_t texture = file.faces[f].corners[k].texture;
      const Eigen::Vector2d uv =
          texture >= 0 ? file.texture_uv[to_index(texture)] : Eigen::Vector2d(0.0, 0.0);
      firsts.emplace_back(points[f][k], uv.x(), uv.y(), own);
    }
  }
  std::sort(firsts.begin(), firsts.end());  // in the file's order of positions
  const auto count = static_cast<Eigen::Index>(firsts.size());
  Surface surface{Points3(count, 3), Points2(count, 2), {}, count_parts(points)};
  std::vector<std::int32_t> number_of(3 * corners.size(), -1);
  for (Eigen::Index v = 0; v < count; ++v) {
    const auto& [point, u, w, corner] = firsts[to_index(v)];
    number_of[to_index(corner)] = static_cast<std::int32_t>(v);
    surface.vertices.row(v) = file.positions[to_index(point)];
    surface.texture.row(v) << u, w;
  }
  surface.faces.resize(static_cast<Eigen::Index>(corners.size()), 3);
  for (std::size_t f = 0; f < corners.size(); ++f) {
    for (std::size_t k = 0; k < 3; ++k) {
      surface.faces(static_cast<Eigen::Index>(f), static_cast<Eigen::Index>(k)) =
          number_of[to_index(corners[f][k])];
    }
  }
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
                  " in the texture: give each part of the surface its own part of the image");
        }
        here.push_back(f);
      }
    }
  }
  return {};
}

}  // namespace weft::mesh
