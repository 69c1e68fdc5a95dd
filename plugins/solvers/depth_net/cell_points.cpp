// SPDX-License-Identifier: Apache-2.0
#include "cell_points.hpp"

#include <algorithm>
#include <cmath>

namespace weft::depth_net {
namespace {

constexpr double kNearest_m = 1e-3, kFarthest_m = 1e3;
// The pixels of a camera image do not resolve less; it also keeps the weights finite.
constexpr double kLeastSigma_m = 1e-4;

}  // namespace

std::vector<CellPoint> cell_points(const inference::Registration& registration,
                                   const std::vector<inference::SeenCell>& cells) {
  const Camera& camera = registration.camera();
  const Eigen::Array2d& size_m = registration.sheet().size_m;
  const double cell_px = registration.cell_px().mean();
  std::vector<CellPoint> points;
  for (const inference::SeenCell& cell : cells) {
    const bool has_depth = cell.depth_m >= kNearest_m && cell.depth_m <= kFarthest_m;
    if (!has_depth || registration.is_beyond(cell)) continue;
    const Eigen::Vector3d ray((cell.image_px.x() - camera.cx) / camera.fx,
                              (cell.image_px.y() - camera.cy) / camera.fy, 1.0);
    CellPoint point;
    point.xy_m = (cell.uv.max(0.0).min(1.0) * size_m).matrix();
    point.point_m = cell.depth_m * ray;
    point.sigma_m =
        std::sqrt(2.0) * std::hypot(ray.norm() * cell.depth_error_m, std::sqrt(2.0) * cell.error_m);
    point.sigma_m = std::max(point.sigma_m, kLeastSigma_m);
    point.size_m = cell.stretch_m_per_px * cell_px;
    points.push_back(point);
  }
  return points;
}

}  // namespace weft::depth_net
