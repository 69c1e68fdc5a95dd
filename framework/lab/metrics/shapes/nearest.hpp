// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <vector>

namespace weft::lab {

/// The corners of a triangle; of a point, all three are the same.
using Corners = std::array<Eigen::Vector3d, 3>;

/// Distance of a point to a triangle, also one without area.
double distance_to(const Corners& corners, const Eigen::Vector3d& point);

/// Triangles and points, to look for the nearest place on them.
class NearestPlace {
 public:
  explicit NearestPlace(std::vector<Corners> triangles);
  ~NearestPlace();

  /// Infinity where there are no triangles.
  double distance(const Eigen::Vector3d& point) const;

 private:
  struct Index;
  std::unique_ptr<Index> index_;
};

/// Points, to look for the nearest one.
class NearestPoint {
 public:
  explicit NearestPoint(const std::vector<Eigen::Vector3d>& points);
  ~NearestPoint();

  /// Infinity where there are no points.
  double distance(const Eigen::Vector3d& point) const;

 private:
  struct Index;
  std::unique_ptr<Index> index_;
};

}  // namespace weft::lab
