// SPDX-License-Identifier: Apache-2.0
#include "raster.hpp"

#include <algorithm>
#include <cmath>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>

namespace weft::overlay {
namespace {

double cross(const cv::Point2d& a, const cv::Point2d& b) { return a.x * b.y - a.y * b.x; }

/// The pixels from `first` to `last` of `size` within the triangle's box.
cv::Rect box_of(const std::array<Corner, 3>& corners, cv::Size size) {
  const auto [left, right] =
      std::minmax({corners[0].at_px.x, corners[1].at_px.x, corners[2].at_px.x});
  const auto [top, bottom] =
      std::minmax({corners[0].at_px.y, corners[1].at_px.y, corners[2].at_px.y});
  const int x0 = static_cast<int>(std::ceil(std::clamp<double>(left, 0.0, size.width)));
  const int y0 = static_cast<int>(std::ceil(std::clamp<double>(top, 0.0, size.height)));
  const int x1 = static_cast<int>(std::floor(std::clamp<double>(right, -1.0, size.width - 1)));
  const int y1 = static_cast<int>(std::floor(std::clamp<double>(bottom, -1.0, size.height - 1)));
  return {x0, y0, std::max(0, x1 - x0 + 1), std::max(0, y1 - y0 + 1)};
}

/// A triangle before its rendering.
struct Triangle {
  const std::array<Corner, 3>& corners;
  const std::array<bool, 3>& sides;
  double line_px;
  std::array<cv::Point2d, 3> gradient;  ///< gradients of the weights, 1/px
  std::array<double, 3> height_px;      ///< above each side

  cv::Vec3d weights(double x, double y) const {
    cv::Vec3d w;
    for (int k = 0; k < 3; ++k) {
      const auto next = to_index((k + 1) % 3), here = to_index(k);
      w[k] = gradient[here].dot(cv::Point2d(x, y) - corners[next].at_px);
    }
    return w;
  }

  /// How much of a line covers a pixel, 0 to 1.
  double line_at(const cv::Vec3d& w) const {
    double covered = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      const double distance_px = w[static_cast<int>(k)] * height_px[k];
      if (sides[k]) covered = std::max(covered, 0.5 * line_px + 0.5 - distance_px);
    }
    return std::min(covered, 1.0);
  }

  void draw(Raster& raster, int x, int y, const cv::Vec3d& w) const {
    const auto& [a, b, c] = corners;
    const double nearness = w[0] * a.nearness + w[1] * b.nearness + w[2] * c.nearness;
    if (nearness <= static_cast<double>(raster.nearness(y, x))) return;
    const cv::Vec3d p = cv::Vec3d(w[0] * a.nearness, w[1] * b.nearness, w[2] * c.nearness) *
                        (1.0 / nearness);  // weights in space
    const cv::Point2d uv = a.uv_px * p[0] + b.uv_px * p[1] + c.uv_px * p[2];
    raster.nearness(y, x) = static_cast<float>(nearness);
    raster.uv_px(y, x) = {static_cast<float>(uv.x), static_cast<float>(uv.y)};
    raster.light(y, x) = static_cast<float>(a.light * p[0] + b.light * p[1] + c.light * p[2]);
    raster.pallor(y, x) = static_cast<float>(a.pallor * p[0] + b.pallor * p[1] + c.pallor * p[2]);
    raster.line(y, x) = static_cast<float>(line_at(w));
  }
};

}  // namespace

Raster::Raster(cv::Size size)
    : nearness(size, 0.0F), uv_px(size), light(size), pallor(size), line(size) {}

void draw_triangle(Raster& raster, const std::array<Corner, 3>& corners,
                   const std::array<bool, 3>& sides, double line_px) {
  const cv::Rect box = box_of(corners, raster.nearness.size());
  const double area =
      cross(corners[1].at_px - corners[0].at_px, corners[2].at_px - corners[0].at_px);
  if (box.empty() || !(std::abs(area) > 1e-9)) return;
  Triangle triangle{corners, sides, line_px, {}, {}};
  for (std::size_t k = 0; k < 3; ++k) {
    const cv::Point2d side = corners[(k + 2) % 3].at_px - corners[(k + 1) % 3].at_px;
    triangle.gradient[k] = cv::Point2d(-side.y, side.x) / area;
    triangle.height_px[k] = 1.0 / std::hypot(triangle.gradient[k].x, triangle.gradient[k].y);
  }
  for (int y = box.y; y < box.y + box.height; ++y) {
    worked(box.width);
    for (int x = box.x; x < box.x + box.width; ++x) {
      const cv::Vec3d w = triangle.weights(x, y);
      if (w[0] >= 0.0 && w[1] >= 0.0 && w[2] >= 0.0) triangle.draw(raster, x, y, w);
    }
  }
  raster.window = raster.window.empty() ? box : raster.window | box;
}

}  // namespace weft::overlay
