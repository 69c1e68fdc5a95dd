// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>
#include <weft/core/index.hpp>

namespace weft::texture {

using Point = Eigen::Vector2d;

/// A grey drawing area with anti-aliased shapes; grey levels 0 (black) to 1, pixel centres at
/// integers.
class Canvas {
 public:
  Canvas(int width, int height, double grey);

  int width() const { return width_; }
  int height() const { return height_; }
  double& at(int x, int y) { return grey_[index(x, y)]; }
  double at(int x, int y) const { return grey_[index(x, y)]; }

  /// Mixes grey into one pixel.
  void blend(int x, int y, double grey, double coverage);
  void disc(Point centre, double radius, double grey);
  void ring(Point centre, double radius, double thickness, double grey);
  /// A polygon that may be concave but does not cross itself.
  void polygon(const std::vector<Point>& corners, double grey);
  /// A line of rounded pieces.
  void polyline(const std::vector<Point>& points, double thickness, double grey);
  /// A rectangle with its sides parallel to the axes.
  void box(Point low, Point high, double grey);
  void frame(Point low, Point high, double thickness, double grey);

  /// 8-bit grey levels, row by row.
  std::vector<std::uint8_t> pixels() const;

 private:
  std::size_t index(int x, int y) const { return to_index(y) * to_index(width_) + to_index(x); }
  /// Fills where distance(point) < 0, with a soft edge of one pixel.
  template <class Distance>
  void fill(Point low, Point high, double grey, const Distance& distance);

  int width_;
  int height_;
  std::vector<double> grey_;
};

}  // namespace weft::texture
