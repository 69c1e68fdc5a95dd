// SPDX-License-Identifier: Apache-2.0
#include "coincidence.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <unordered_map>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>

namespace weft::mesh {
namespace {

using Cell = std::array<std::int64_t, 3>;

struct CellHash {
  std::size_t operator()(const Cell& cell) const {
    std::uint64_t hash = 0;
    for (const std::int64_t index : cell) {
      hash = (hash ^ static_cast<std::uint64_t>(index)) * 0x9E3779B97F4A7C15ULL;
      hash ^= hash >> 29U;
    }
    return hash;
  }
};

/// Decimal rounding makes differences of exactly the tolerance, which binary numbers may exceed.
constexpr double kTolerance = kCoincident * (1.0 + 1e-6);

std::int64_t cell_of(double coordinate, double tolerance) {
  constexpr double kMost = 1e15;  // beyond, no mesh is legal
  return static_cast<std::int64_t>(std::floor(std::clamp(coordinate / tolerance, -kMost, kMost)));
}

/// Finds the first item that is the same as another one, among those in the cells around it, whose
/// sides are as long as the tolerance.
class Firsts {
 public:
  /// The first item that is_same(item) holds for, or `own`, which is a first one then. Cells differ
  /// by up to one in each of the places in `around`.
  template <class IsSame>
  std::int32_t first_of(std::int32_t own, const Cell& home, std::array<int, 3> around,
                        IsSame&& is_same) {
    std::int32_t found = own;
    for (std::int64_t i = -around[0]; i <= around[0]; ++i) {
      for (std::int64_t j = -around[1]; j <= around[1]; ++j) {
        for (std::int64_t k = -around[2]; k <= around[2]; ++k) {
          const auto cell = firsts_in_.find({home[0] + i, home[1] + j, home[2] + k});
          if (cell == firsts_in_.end()) continue;
          for (const std::int32_t other : cell->second) {
            if (other < found && is_same(other)) found = other;
          }
        }
      }
    }
    if (found == own) firsts_in_[home].push_back(own);
    return found;
  }

 private:
  std::unordered_map<Cell, std::vector<std::int32_t>, CellHash> firsts_in_;
};

}  // namespace

std::vector<std::int32_t> first_positions(const MeshFile& file) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& position : file.positions) box.extend(position);
  const double tolerance = kTolerance * (box.isEmpty() ? 0.0 : box.diagonal().norm());
  if (!(tolerance > 0.0) || !std::isfinite(tolerance)) {
    return std::vector<std::int32_t>(file.positions.size(), 0);
  }
  Firsts firsts;
  std::vector<std::int32_t> first;
  for (const Eigen::Vector3d& position : file.positions) {
    const auto own = static_cast<std::int32_t>(first.size());
    worked_in_loop(own, 27);
    const Eigen::Vector3d from_corner = position - box.min();
    const Cell home{cell_of(from_corner.x(), tolerance), cell_of(from_corner.y(), tolerance),
                    cell_of(from_corner.z(), tolerance)};
    first.push_back(firsts.first_of(own, home, {1, 1, 1}, [&](std::int32_t other) {
      return (file.positions[to_index(other)] - position).norm() <= tolerance;
    }));
  }
  return first;
}

std::vector<std::int32_t> first_corners(const MeshFile& file,
                                        const std::vector<std::int32_t>& first_position) {
  const auto texture_of = [&](std::int32_t corner) -> Eigen::Vector2d {
    const auto& [position, texture] =
        file.faces[to_index(corner / 3)].corners[to_index(corner % 3)];
    return texture >= 0 ? file.texture_uv[to_index(texture)] : Eigen::Vector2d(0.0, 0.0);
  };
  Firsts firsts;
  std::vector<std::int32_t> first;
  for (const MeshFile::Face& face : file.faces) {
    for (const MeshFile::Corner& corner : face.corners) {
      const auto own = static_cast<std::int32_t>(first.size());
      worked_in_loop(own, 9);
      const Eigen::Vector2d uv = texture_of(own);
      const Cell home{first_position[to_index(corner.position)], cell_of(uv.x(), kTolerance),
                      cell_of(uv.y(), kTolerance)};
      first.push_back(firsts.first_of(own, home, {0, 1, 1}, [&](std::int32_t other) {
        return (texture_of(other) - uv).cwiseAbs().maxCoeff() <= kTolerance;
      }));
    }
  }
  return first;
}

std::int64_t remove_faces_without_area(MeshFile& file,
                                       const std::vector<std::int32_t>& first_position) {
  Eigen::AlignedBox3d box;
  for (const MeshFile::Face& face : file.faces) {
    for (const MeshFile::Corner& corner : face.corners) {
      box.extend(file.positions[to_index(corner.position)]);
    }
  }
  const double least = box.isEmpty() ? 0.0 : 1e-12 * box.diagonal().squaredNorm();
  return static_cast<std::int64_t>(std::erase_if(file.faces, [&](const MeshFile::Face& face) {
    std::array<std::int32_t, 3> points{};
    for (std::size_t k = 0; k < 3; ++k) {
      points[k] = first_position[to_index(face.corners[k].position)];
    }
    if (points[0] == points[1] || points[1] == points[2] || points[2] == points[0]) return true;
    const Eigen::Vector3d& origin = file.positions[to_index(points[0])];
    const Eigen::Vector3d a = file.positions[to_index(points[1])] - origin;
    const Eigen::Vector3d b = file.positions[to_index(points[2])] - origin;
    return !(0.5 * a.cross(b).norm() > least);
  }));
}

Array<std::int32_t> welded_vertices(const Points3& vertices) {
  std::map<std::array<double, 3>, std::int32_t> first_at;
  Array<std::int32_t> welded({vertices.rows()});
  bool has_seam = false;
  for (std::int32_t v = 0; v < vertices.rows(); ++v) {
    worked_in_loop(v, 30);
    // Adding 0 turns -0 into 0; both are the same place.
    const std::array<double, 3> place{vertices(v, 0) + 0.0, vertices(v, 1) + 0.0,
                                      vertices(v, 2) + 0.0};
    welded(v) = first_at.try_emplace(place, v).first->second;
    has_seam = has_seam || welded(v) != v;
  }
  return has_seam ? welded : Array<std::int32_t>();
}

}  // namespace weft::mesh
