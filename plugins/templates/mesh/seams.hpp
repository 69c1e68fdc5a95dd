// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>
#include <weft/core/index.hpp>

#include "chart.hpp"
#include "common/plane_mesh.hpp"
#include "common/polygon.hpp"

namespace weft::mesh {

/// A chart in a plane whose texels are as large as on the surface, in a unit common to all charts.
struct Plane {
  Chart chart;
  Eigen::RowVector2d scale;  ///< [] of the plane to px of the texture, along u and v
  outline::Outline outline;
};

/// Some of the chart's vertices in its plane.
outline::Polygon polygon_along(const Plane& plane, const std::vector<std::int32_t>& vertices);

/// A vertex of a new mesh that has exactly one place on the surface for all charts around it.
struct SharedVertex {
  Eigen::RowVector3d place_m;
  Eigen::RowVector2d flat_px;  ///< in this chart
};

/// A chart that is meshed anew.
struct ChartMesh {
  outline::PlaneMesh plane;
  std::map<std::int32_t, SharedVertex> shared = {};  ///< by the number of the vertex
};

/// The seams of a surface: lines in space on which the borders of charts meet, and the new vertices
/// on them. Both sides of a seam get the same vertices: those that are spread over its length in
/// space, and those that the mesh of either side needs in addition.
class Seams {
 public:
  explicit Seams(const std::vector<Plane>& planes);

  bool empty() const { return !has_seam_; }
  /// Meshes all charts with edges of about `spacing_px` in their planes, `unit_m` being the size of
  /// a plane's unit. Nothing where borders cross or a chart is lost.
  std::vector<ChartMesh> fill(double spacing_px, double unit_m, int smoothing_rounds);

 private:
  struct Point {
    double along_m = 0.0;
    Eigen::RowVector3d place_m;
  };
  /// A seam between two stops, from one end to the other.
  struct Seam {
    std::vector<std::int32_t> points;  ///< dense points along it
    std::vector<double> along_m;       ///< [.] of them, from its beginning
    int fewest = 1;                    ///< sides that it needs at least
    std::vector<Point> inner;          ///< new vertices between its ends, by their place along it
  };
  /// A corner of a new border. A seam or an open piece goes on from here to the next corner.
  struct Corner {
    Eigen::Vector2d in_plane;
    std::optional<SharedVertex> shared;
    std::int32_t seam = -1;                    ///< -1: open piece
    double along_m = 0.0, next_along_m = 0.0;  ///< on the seam, here and at the next corner
    std::vector<std::int32_t> vertices;  ///< [.] vertices of the chart from the seam's beginning
  };
  using Border = std::vector<Corner>;

  std::int32_t point_of(std::size_t chart, std::int32_t vertex) const {
    return points_[chart][to_index(vertex)];
  }
  bool is_seam(std::int32_t a, std::int32_t b) const;
  void mark_stops(double spacing_px);
  std::vector<std::size_t> stops_of(std::size_t chart,
                                    const std::vector<std::int32_t>& border) const;
  /// The number of the seam with these points, and whether they go along it backwards.
  std::pair<std::int32_t, bool> seam_of(std::vector<std::int32_t> points);
  void spread(double spacing_m);
  Border border_of(std::size_t chart, const std::vector<std::int32_t>& border, double spacing_px);
  void add_seam(const Plane& plane, std::vector<std::int32_t> vertices, std::int32_t seam,
                bool is_backwards, Border& border) const;
  bool add_point(std::int32_t seam, double along_m);
  Eigen::RowVector2d flat_at(const Plane& plane, const Corner& corner, double along_m) const;
  /// Collects the vertices that the mesh has on seams besides the corners; false where it has lost
  /// a corner.
  bool add_points_of(const outline::PlaneMesh& mesh, const std::vector<Border>& borders,
                     bool& has_grown);
  std::vector<Point> points_behind(const Corner& corner) const;
  void share_side(const Plane& plane, const Corner& corner, const std::vector<std::int32_t>& side,
                  const std::vector<double>& along_m, ChartMesh& mesh) const;
  std::optional<outline::PlaneMesh> fill_chart(std::size_t chart, double spacing_px,
                                               int smoothing_rounds, std::vector<Border>& borders);
  bool share(const Plane& plane, const std::vector<Border>& borders, ChartMesh& mesh) const;

  const std::vector<Plane>& planes_;
  bool has_seam_ = false;
  std::vector<std::vector<std::int32_t>> points_;  ///< dense point of each chart's vertices
  std::vector<Eigen::RowVector3d> dense_m_;        ///< places of the dense points
  std::map<std::pair<std::int32_t, std::int32_t>, int> sides_at_;  ///< borders at an edge
  std::vector<bool> is_stop_;                                      ///< [.] dense points
  std::vector<Seam> seams_;
  std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> seam_from_;  ///< by first points
};

}  // namespace weft::mesh
