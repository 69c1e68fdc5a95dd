// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/result.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/geometry/barycentric.hpp>
#include <weft/geometry/mesh_topology.hpp>
#include <weft/geometry/mesh_validation.hpp>
#include <weft/geometry/types.hpp>

namespace weft {

/// Position of a texture point on the mesh.
struct FaceLocation {
  std::int32_t face = -1;                             ///< [] face index, -1 outside
  Eigen::Vector3d weights = Eigen::Vector3d::Zero();  ///< [3] sum 1; all 0 when face is -1
  bool inside = false;                                ///< [] false if extrapolated
};

/// Finds the face of a flat mesh that contains a point, with a uniform grid of cells as large as
/// the mean edge. Inside a face, all weights are >= -1e-9 and the lowest face index wins. Outside
/// the mesh but within the maximum distance, the closest face (by distance from its sides) is
/// returned. Its unclamped weights may go down to -0.5. Otherwise there is no face. Degenerate
/// faces are never returned.
class FaceLocator {
 public:
  static constexpr double kInsideTolerance = 1e-9;
  static constexpr double kLeastWeight = -0.5;

  /// Copies the mesh. The default of `max_distance_px` is half of the mean edge.
  static Result<FaceLocator> create(const Points2View& flat_px, const FacesView& faces,
                                    std::optional<double> max_distance_px = {}) {
    auto topology = build_topology(faces, flat_px.rows());
    if (!topology) return topology.error();
    if (auto checked = detail::check_finite(flat_px); !checked) return checked.error();
    const double mean_edge = mean_edge_length(flat_px, topology->edges);
    if (!(mean_edge > 0.0) || !std::isfinite(flat_px.squaredNorm())) {
      return detail::bad_mesh("the flat mesh has no extent or an infinite one: give faces in px");
    }
    const double reach = max_distance_px.value_or(0.5 * mean_edge);
    if (!(reach >= 0.0) || std::isinf(reach)) {
      return Error{Errc::invalid_value, "max_distance_px must be a finite number >= 0"};
    }
    FaceLocator locator(flat_px, faces, reach);
    locator.fill_grid(mean_edge);
    return locator;
  }

  FaceLocation locate(const Eigen::Vector2d& point_px) const {
    if (!point_px.allFinite()) return {};
    for (const std::int32_t face : cells_[cell_index(column(point_px.x()), row(point_px.y()))]) {
      const Eigen::Vector3d weights = weights_in(face, point_px);
      if (weights.minCoeff() >= -kInsideTolerance) return {face, weights, true};
    }
    return closest(point_px);
  }

  double max_distance_px() const { return max_distance_px_; }

 private:
  FaceLocator(const Points2View& flat_px, const FacesView& faces, double max_distance_px)
      : flat_px_(flat_px), faces_(faces), max_distance_px_(max_distance_px) {}

  Eigen::Vector2d corner(std::int32_t face, int k) const { return flat_px_.row(faces_(face, k)); }

  Eigen::Vector3d weights_in(std::int32_t face, const Eigen::Vector2d& p) const {
    return barycentric_weights(p, corner(face, 0), corner(face, 1), corner(face, 2));
  }

  int column(double u) const { return cell_along(u - low_.x(), columns_); }
  int row(double v) const { return cell_along(v - low_.y(), rows_); }
  int cell_along(double offset, int count) const {
    return static_cast<int>(std::clamp(std::floor(offset / cell_px_), 0.0, count - 1.0));
  }
  std::size_t cell_index(int i, int j) const {
    return to_index(j) * to_index(columns_) + to_index(i);
  }

  void fill_grid(double mean_edge) {
    low_ = flat_px_.colwise().minCoeff();
    const Eigen::Vector2d extent = flat_px_.colwise().maxCoeff().transpose() - low_;
    // Sliver meshes have tiny edges in a wide box; larger cells bound the memory.
    const double most_cells = 64.0 + 16.0 * static_cast<double>(faces_.rows());
    cell_px_ = mean_edge;
    while ((extent.x() / cell_px_ + 1.0) * (extent.y() / cell_px_ + 1.0) > most_cells) {
      cell_px_ *= 2.0;
    }
    columns_ = static_cast<int>(extent.x() / cell_px_) + 1;
    rows_ = static_cast<int>(extent.y() / cell_px_) + 1;
    cells_.resize(cell_index(0, rows_));
    for (std::int32_t f = 0; f < faces_.rows(); ++f) {
      worked_in_loop(f, 20);
      if (weights_in(f, corner(f, 0)).allFinite()) insert(f);
    }
  }

  void insert(std::int32_t f) {
    const Eigen::Vector2d a = corner(f, 0), b = corner(f, 1), c = corner(f, 2);
    const Eigen::Vector2d low = a.cwiseMin(b).cwiseMin(c), high = a.cwiseMax(b).cwiseMax(c);
    const double margin =
        1e-8 * (high - low).maxCoeff();  // covers the tolerance of the inside test
    for (int j = row(low.y() - margin); j <= row(high.y() + margin); ++j) {
      for (int i = column(low.x() - margin); i <= column(high.x() + margin); ++i) {
        cells_[cell_index(i, j)].push_back(f);
      }
    }
  }

  FaceLocation closest(const Eigen::Vector2d& p) const {
    // Ties (a shared corner) go to a face that may be extrapolated, then to the lowest index.
    std::tuple<double, bool, std::int32_t> best{max_distance_px_ * max_distance_px_, true, -1};
    FaceLocation location;
    for (int j = row(p.y() - max_distance_px_); j <= row(p.y() + max_distance_px_); ++j) {
      for (int i = column(p.x() - max_distance_px_); i <= column(p.x() + max_distance_px_); ++i) {
        for (const std::int32_t f : cells_[cell_index(i, j)]) {
          const Eigen::Vector2d a = corner(f, 0), b = corner(f, 1), c = corner(f, 2);
          const double distance2 = std::min(
              {segment_distance2(p, a, b), segment_distance2(p, b, c), segment_distance2(p, c, a)});
          if (distance2 > std::get<0>(best)) continue;
          const Eigen::Vector3d weights = barycentric_weights(p, a, b, c);
          const std::tuple candidate{distance2, !(weights.minCoeff() >= kLeastWeight), f};
          if (location.face >= 0 && !(candidate < best)) continue;
          best = candidate;
          location = {f, weights, false};
        }
      }
    }
    return std::get<1>(best) ? FaceLocation{} : location;
  }

  Points2 flat_px_;
  Faces faces_;
  double max_distance_px_ = 0.0;
  Eigen::Vector2d low_ = Eigen::Vector2d::Zero();
  double cell_px_ = 1.0;
  int columns_ = 1;
  int rows_ = 1;
  std::vector<std::vector<std::int32_t>> cells_;
};

}  // namespace weft
