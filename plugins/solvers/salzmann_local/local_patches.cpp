// SPDX-License-Identifier: Apache-2.0
#include "local_patches.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>
#include <utility>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/mesh_adjacency.hpp>
#include <weft/geometry/rectangular_grid.hpp>

namespace weft::salzmann_local {
namespace {

constexpr std::int64_t kSide = 5;  // vertices
constexpr std::size_t kNearest = 25;

/// Columns of the grid that the mesh is, 0 where it is none.
std::int64_t columns_of(const FacesView& faces, std::int64_t vertex_count) {
  // (columns - 1) (rows - 1) = faces / 2 gives columns + rows.
  const std::int64_t sum = vertex_count + 1 - faces.rows() / 2;
  const double root2 = static_cast<double>(sum * sum - 4 * vertex_count);
  if (!(root2 >= 0.0)) return 0;
  for (const double sign : {1.0, -1.0}) {
    const std::int64_t columns =
        std::llround(0.5 * (static_cast<double>(sum) + sign * std::sqrt(root2)));
    if (columns < 2 || vertex_count % columns != 0) continue;
    const auto grid = rectangular_grid_faces(columns, vertex_count / columns);
    if (grid && grid->rows() == faces.rows() && *grid == faces) return columns;
  }
  return 0;
}

LocalPatches windows(std::int64_t columns, std::int64_t rows) {
  const std::int64_t width = std::min(columns, kSide), height = std::min(rows, kSide);
  LocalPatches patches;
  for (std::int64_t top = 0; top + height <= rows; ++top) {
    for (std::int64_t left = 0; left + width <= columns; ++left) {
      std::vector<std::int32_t>& patch = patches.emplace_back();
      for (std::int64_t row = top; row < top + height; ++row) {
        for (std::int64_t column = left; column < left + width; ++column) {
          patch.push_back(static_cast<std::int32_t>(row * columns + column));
        }
      }
    }
  }
  return patches;
}

/// Finds the vertices that are nearest along the edges (Dijkstra).
class NearestVertices {
 public:
  NearestVertices(const Points3View& rest_m, const EdgesView& edges)
      : rest_m_(rest_m),
        neighbours_(vertex_neighbours(edges, rest_m.rows())),
        distance_m_(to_index(rest_m.rows()), std::numeric_limits<double>::infinity()) {}

  std::vector<std::int32_t> of(std::int32_t vertex) {
    std::vector<std::int32_t> nearest, touched{vertex};
    queue_ = {};
    distance_m_[to_index(vertex)] = 0.0;
    queue_.emplace(0.0, vertex);
    while (!queue_.empty() && nearest.size() < kNearest) {
      const auto [distance_m, at] = queue_.top();
      queue_.pop();
      if (distance_m > distance_m_[to_index(at)]) continue;
      nearest.push_back(at);
      for (const std::int32_t next : neighbours_[at]) {
        const double through_m = distance_m + (rest_m_.row(at) - rest_m_.row(next)).norm();
        if (!(through_m < distance_m_[to_index(next)])) continue;
        distance_m_[to_index(next)] = through_m;
        touched.push_back(next);
        queue_.emplace(through_m, next);
      }
    }
    for (const std::int32_t v : touched) {
      distance_m_[to_index(v)] = std::numeric_limits<double>::infinity();
    }
    std::sort(nearest.begin(), nearest.end());
    return nearest;
  }

 private:
  using Entry = std::pair<double, std::int32_t>;

  Points3View rest_m_;
  IndexLists neighbours_;
  std::vector<double> distance_m_;  ///< [V] m, infinite between calls
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue_;
};

}  // namespace

LocalPatches local_patches(const Template& templ, const MeshTopology& topology) {
  const auto rest_m = templ.vertices_m.matrix<3>();
  if (const std::int64_t columns = columns_of(templ.faces.matrix<3>(), rest_m.rows());
      columns > 0) {
    return windows(columns, rest_m.rows() / columns);
  }
  LocalPatches patches;
  NearestVertices nearest(rest_m, topology.edges);
  for (std::int32_t v = 0; v < rest_m.rows(); ++v) {
    worked_in_loop(v, 1000);
    patches.push_back(nearest.of(v));
  }
  return patches;
}

}  // namespace weft::salzmann_local
