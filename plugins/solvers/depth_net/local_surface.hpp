// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "cell_points.hpp"
#include "planar_frame.hpp"

namespace weft::depth_net {

/// The surface near a place of the template.
struct FittedPoint {
  Eigen::Vector3d point_m = Eigen::Vector3d::Zero();  ///< camera frame
  double sigma_m = 0.0;  ///< standard deviation if the errors of near cells are the same
};

/// A rigid placement of the template: X = frame (xy - origin_m) + point_m.
struct Placement {
  Frame frame = Frame::Zero();
  Eigen::Vector2d origin_m = Eigen::Vector2d::Zero();
  Eigen::Vector3d point_m = Eigen::Vector3d::Zero();

  Eigen::Vector3d at(const Eigen::Vector2d& xy_m) const {
    return frame * (xy_m - origin_m) + point_m;
  }
};

/// The points of the cells as functions of the template plane, fitted around any place of it.
class LocalSurface {
 public:
  /// `reach_m` is the radius of the rigid placements.
  LocalSurface(std::vector<CellPoint> cells, double reach_m);

  /// Moving least squares over 2.5 cells: quadratic, or linear where too few cells or cells on one
  /// side only determine no quadratic. The weights are 1 / sigma^2, a kernel of the distance and
  /// Cauchy's loss. Nothing without a cell within one cell of the place.
  std::optional<FittedPoint> at(const Eigen::Vector2d& xy_m) const;

  /// Index of the cell nearest to a place; there must be one.
  std::size_t nearest(const Eigen::Vector2d& xy_m) const;

  /// The rigid placement of the template on the cells around a cell, by Procrustes alignment with
  /// Cauchy's loss. The radius doubles until the rotation is determined. Nothing if no radius
  /// determines it.
  std::optional<Placement> placement_around(std::size_t cell) const;

  const std::vector<CellPoint>& cells() const { return cells_; }

 private:
  struct Neighbour {
    const CellPoint* cell;
    double distance_m;  ///< in the template plane
  };
  using Neighbours = std::vector<Neighbour>;

  Neighbours within(const Eigen::Vector2d& xy_m, double radius_m) const;
  static std::optional<Placement> placed_on(const Neighbours& near);
  double cell_size_at(const Eigen::Vector2d& xy_m) const;

  std::vector<CellPoint> cells_;
  double reach_m_;
};

}  // namespace weft::depth_net
