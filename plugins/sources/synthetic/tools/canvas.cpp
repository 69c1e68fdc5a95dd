// SPDX-License-Identifier: Apache-2.0
#include "canvas.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <weft/core/index.hpp>

namespace weft::texture {
namespace {

double segment_distance(const Point& p, const Point& a, const Point& b) {
  const Point ab = b - a;
  const double along = std::clamp(ab.dot(p - a) / std::max(ab.squaredNorm(), 1e-12), 0.0, 1.0);
  return (p - a - along * ab).norm();
}

bool inside_polygon(const Point& p, const std::vector<Point>& corners) {
  bool inside = false;
  for (std::size_t i = 0, j = corners.size() - 1; i < corners.size(); j = i++) {
    const Point &a = corners[i], &b = corners[j];
    if ((a.y() > p.y()) != (b.y() > p.y()) &&
        p.x() < (b.x() - a.x()) * (p.y() - a.y()) / (b.y() - a.y()) + a.x()) {
      inside = !inside;
    }
  }
  return inside;
}

struct Bounds {
  Point low = Point::Constant(std::numeric_limits<double>::max());
  Point high = Point::Constant(std::numeric_limits<double>::lowest());
};

Bounds bounds_of(const std::vector<Point>& points) {
  Bounds bounds;
  for (const Point& p : points) {
    bounds.low = bounds.low.cwiseMin(p);
    bounds.high = bounds.high.cwiseMax(p);
  }
  return bounds;
}

}  // namespace

Canvas::Canvas(int width, int height, double grey)
    : width_(width), height_(height), grey_(to_index(width) * to_index(height), grey) {}

void Canvas::blend(int x, int y, double grey, double coverage) {
  double& value = at(x, y);
  value += std::clamp(coverage, 0.0, 1.0) * (grey - value);
}

template <class Distance>
void Canvas::fill(Point low, Point high, double grey, const Distance& distance) {
  const int x0 = std::max(0, static_cast<int>(std::floor(low.x() - 1.0)));
  const int y0 = std::max(0, static_cast<int>(std::floor(low.y() - 1.0)));
  const int x1 = std::min(width_ - 1, static_cast<int>(std::ceil(high.x() + 1.0)));
  const int y1 = std::min(height_ - 1, static_cast<int>(std::ceil(high.y() + 1.0)));
  for (int y = y0; y <= y1; ++y) {
    for (int x = x0; x <= x1; ++x) blend(x, y, grey, 0.5 - distance(Point(x, y)));
  }
}

void Canvas::disc(Point centre, double radius, double grey) {
  const Point reach = Point::Constant(radius);
  fill(centre - reach, centre + reach, grey,
       [&](const Point& p) { return (p - centre).norm() - radius; });
}

void Canvas::ring(Point centre, double radius, double thickness, double grey) {
  const Point reach = Point::Constant(radius + thickness);
  fill(centre - reach, centre + reach, grey,
       [&](const Point& p) { return std::abs((p - centre).norm() - radius) - 0.5 * thickness; });
}

void Canvas::polygon(const std::vector<Point>& corners, double grey) {
  const Bounds bounds = bounds_of(corners);
  fill(bounds.low, bounds.high, grey, [&](const Point& p) {
    double nearest = std::numeric_limits<double>::max();
    for (std::size_t i = 0, j = corners.size() - 1; i < corners.size(); j = i++) {
      nearest = std::min(nearest, segment_distance(p, corners[i], corners[j]));
    }
    return inside_polygon(p, corners) ? -nearest : nearest;
  });
}

void Canvas::polyline(const std::vector<Point>& points, double thickness, double grey) {
  const Bounds bounds = bounds_of(points);
  const Point reach = Point::Constant(thickness);
  fill(bounds.low - reach, bounds.high + reach, grey, [&](const Point& p) {
    double nearest = std::numeric_limits<double>::max();
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
      nearest = std::min(nearest, segment_distance(p, points[i], points[i + 1]));
    }
    return nearest - 0.5 * thickness;
  });
}

void Canvas::box(Point low, Point high, double grey) {
  polygon({low, {high.x(), low.y()}, high, {low.x(), high.y()}}, grey);
}

void Canvas::frame(Point low, Point high, double thickness, double grey) {
  polyline({low, {high.x(), low.y()}, high, {low.x(), high.y()}, low}, thickness, grey);
}

std::vector<std::uint8_t> Canvas::pixels() const {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(grey_.size());
  for (const double grey : grey_) {
    bytes.push_back(static_cast<std::uint8_t>(std::lround(255.0 * std::clamp(grey, 0.0, 1.0))));
  }
  return bytes;
}

}  // namespace weft::texture
