// SPDX-License-Identifier: Apache-2.0
#include "sheet_map.hpp"

#include <algorithm>
#include <cmath>
#include <vector>
#include <weft/core/rng.hpp>

#include "terrain.hpp"

namespace weft::texture {
namespace {

constexpr double kPaper = 0.93;
constexpr double kMargin = 26.0;

/// A glyph of no alphabet in the box (0,0)-(0.7,1): a few strokes between the nodes of a 3 x 4
/// grid.
void draw_glyph(Canvas& canvas, const Point& corner, double size, double turn, Rng& rng,
                double grey) {
  const Point along(std::cos(turn), std::sin(turn)), down(-along.y(), along.x());
  const auto node = [&]() {
    return Point(corner + size * (0.35 * rng.below(3) * along + rng.below(4) / 3.0 * down));
  };
  const double thickness = std::max(1.0, 0.15 * size);
  std::vector<Point> stroke{node()};
  const int pieces = 2 + static_cast<int>(rng.below(3));
  while (static_cast<int>(stroke.size()) <= pieces) {
    const Point next = node();
    if ((next - stroke.back()).norm() > 0.1 * size) stroke.push_back(next);
  }
  canvas.polyline(stroke, thickness, grey);
  if (rng.below(3) == 0) canvas.disc(node(), 0.11 * size + 0.3, grey);
}

/// A word with a light halo that keeps it legible on the relief.
void draw_word(Canvas& canvas, Point corner, double size, double turn, int letters, Rng& rng,
               double halo = 0.0) {
  const Point along(std::cos(turn), std::sin(turn)), down(-along.y(), along.x());
  if (halo > 0.0) {
    const Point start = corner + 0.5 * size * down;
    canvas.polyline({start, start + (letters - 0.2) * size * along}, 1.5 * size, halo);
  }
  for (int i = 0; i < letters; ++i, corner += size * along) {
    draw_glyph(canvas, corner, size, turn, rng, kInk);
  }
}

std::vector<Point> box_corners(const Point& centre, double width, double height, double turn) {
  const Point a = 0.5 * width * Point(std::cos(turn), std::sin(turn));
  const Point b = 0.5 * height * Point(-std::sin(turn), std::cos(turn));
  return {centre - a - b, centre + a - b, centre + a + b, centre - a + b};
}

enum class Ground { land, sea };

class MapPainter {
 public:
  MapPainter(int width, int height, std::uint64_t seed)
      : rng_(seed), terrain_(width, height, rng_), canvas_(width, height, kPaper) {}

  Canvas paint() {
    draw_relief(terrain_, canvas_);
    const std::vector<Point> towns = places(24, 78.0);
    for (std::size_t i = 1; i < towns.size(); ++i) draw_road(towns[i], nearest(towns, i));
    for (const Point& wood : places(34, 40.0)) draw_wood(wood);
    for (const Point& peak : places(40, 30.0)) draw_peak(peak);
    for (const Point& town : towns) draw_town(town);
    for (const Point& depth : places(60, 26.0, Ground::sea)) draw_sounding(depth);
    for (const Point& ship : places(5, 90.0, Ground::sea)) draw_ship(ship);
    draw_compass({0.865 * canvas_.width(), 0.8 * canvas_.height()}, 0.1 * canvas_.height());
    draw_title({0.055 * canvas_.width(), 0.075 * canvas_.height()});
    draw_border();
    return canvas_;
  }

 private:
  Point random_point() {
    return {rng_.uniform(kMargin + 14.0, canvas_.width() - kMargin - 14.0),
            rng_.uniform(kMargin + 14.0, canvas_.height() - kMargin - 14.0)};
  }

  /// Random places on land or at sea, apart from each other.
  std::vector<Point> places(std::size_t most, double distance, Ground ground = Ground::land) {
    std::vector<Point> found;
    for (int tries = 0; tries < 4000 && found.size() < most; ++tries) {
      const Point p = random_point();
      const bool free = std::all_of(found.begin(), found.end(),
                                    [&](const Point& q) { return (p - q).norm() > distance; });
      const double height = terrain_(p);
      const bool fits = ground == Ground::land ? height > 0.04 : height < -0.02;
      if (free && fits) found.push_back(p);
    }
    return found;
  }

  /// The nearest of the places before `index`.
  static Point nearest(const std::vector<Point>& points, std::size_t index) {
    const Point& from = points[index];
    return *std::min_element(
        points.begin(), points.begin() + static_cast<std::ptrdiff_t>(index),
        [&](const Point& a, const Point& b) { return (a - from).norm() < (b - from).norm(); });
  }

  void draw_road(const Point& from, const Point& to) {
    const Point across = Point(to.y() - from.y(), from.x() - to.x()).normalized();
    const double bow = rng_.uniform(-14.0, 14.0), wiggle = rng_.uniform(-6.0, 6.0);
    std::vector<Point> path;
    for (int i = 0; i <= 24; ++i) {
      const double s = i / 24.0;
      path.emplace_back(from + s * (to - from) +
                        (bow * std::sin(M_PI * s) + wiggle * std::sin(3.0 * M_PI * s)) * across);
    }
    const double width = rng_.uniform(3.4, 5.4);
    canvas_.polyline(path, width, kInk);
    canvas_.polyline(path, width - 2.2, 0.95);
  }

  void draw_town(const Point& centre) {
    const double size = rng_.uniform(12.0, 30.0);
    const int houses = static_cast<int>(size * 0.8);
    for (int i = 0; i < houses; ++i) {
      const Point place = centre + size * Point(0.6 * rng_.normal(), 0.5 * rng_.normal());
      const double turn = rng_.uniform(0.0, M_PI);
      const double width = rng_.uniform(3.0, 9.0), height = rng_.uniform(3.0, 6.0);
      canvas_.polygon(box_corners(place, width + 1.6, height + 1.6, turn), 0.93);
      canvas_.polygon(box_corners(place, width, height, turn), rng_.uniform(0.12, 0.4));
    }
    const double radius = rng_.uniform(3.5, 7.5);
    canvas_.disc(centre, radius + 1.6, kInk);
    canvas_.disc(centre, radius, 0.96);
    canvas_.disc(centre, 0.45 * radius, kInk);
    const int letters = 3 + static_cast<int>(rng_.below(6));
    const double height = 7.0 + 0.2 * size + rng_.uniform(-1.0, 2.0);
    draw_word(canvas_, centre + Point(radius + 4.0, -1.6 * height), height,
              rng_.uniform(-0.35, 0.35), letters, rng_, 0.94);
  }

  void draw_wood(const Point& centre) {
    const double size = rng_.uniform(10.0, 32.0);
    for (int i = 0; i < static_cast<int>(size); ++i) {
      const Point place = centre + size * Point(rng_.normal(), 0.6 * rng_.normal());
      const double radius = rng_.uniform(1.6, 4.6);
      if (terrain_(place) < 0.02) continue;
      canvas_.disc(place + Point(0.35, 0.45) * radius, radius, 0.2);
      canvas_.disc(place, radius, 0.44);
      canvas_.disc(place - Point(0.3, 0.3) * radius, 0.4 * radius, 0.72);
    }
  }

  void draw_peak(const Point& top) {
    const double size = rng_.uniform(3.5, 8.5);
    const double lean = rng_.uniform(-0.4, 0.4) * size;
    const Point left(-size, 1.2 * size), right(size, 1.2 * size), foot(lean, 1.2 * size);
    canvas_.polygon({top, top + right, top + left}, 0.95);
    canvas_.polygon({top, top + right, top + foot}, kInk);
    canvas_.polyline({top, top + right, top + left, top}, 1.2, kInk);
    draw_word(canvas_, top + Point(size + 2.0, 0.2 * size), 5.5, 0.0,
              2 + static_cast<int>(rng_.below(3)), rng_);
  }

  void draw_sounding(const Point& place) {
    const double size = rng_.uniform(6.0, 9.0);
    draw_word(canvas_, place, size, rng_.uniform(-0.2, 0.2), 1 + static_cast<int>(rng_.below(3)),
              rng_);
  }

  /// A hull, two sails that are blown up differently on each ship, and a wake.
  void draw_ship(const Point& place) {
    const double size = rng_.uniform(9.0, 15.0), course = rng_.below(2) == 0 ? -1.0 : 1.0;
    const auto at = [&](double x, double y) { return Point(place + size * Point(course * x, y)); };
    canvas_.polygon({at(-1, 0), at(1.1, -0.15), at(0.7, 0.45), at(-0.7, 0.45)}, kInk);
    for (const double mast : {-0.35, 0.35}) {
      const double blow = rng_.uniform(0.25, 0.6), top = rng_.uniform(-1.5, -1.0);
      const std::vector<Point> sail{at(mast, top), at(mast + blow, 0.5 * top), at(mast, -0.1)};
      canvas_.polygon(sail, 0.96);
      canvas_.polyline({sail[0], sail[1], sail[2], sail[0]}, 1.3, kInk);
    }
    for (int i = 0; i < 4; ++i) {
      const double x = rng_.uniform(-1.6, 0.8), y = 0.65 + 0.16 * i;
      canvas_.polyline({at(x, y), at(x + rng_.uniform(0.3, 0.9), y)}, 1.2, kInk);
    }
  }

  void draw_compass(const Point& centre, double radius) {
    canvas_.disc(centre, 1.12 * radius, 0.93);
    canvas_.ring(centre, radius, 1.6, kInk);
    canvas_.ring(centre, 0.9 * radius, 1.0, kInk);
    for (int i = 7; i >= 0; --i) {
      const double turn = 0.21 + 0.25 * M_PI * (i % 2 == 0 ? i : 8 - i);
      const double reach = i % 2 == 0 ? (i == 6 ? 1.18 : 0.95) * radius : 0.6 * radius;
      const Point tip = centre + reach * Point(std::cos(turn), std::sin(turn));
      const Point side = 0.16 * radius * Point(std::cos(turn + 0.785), std::sin(turn + 0.785));
      const Point other = 0.16 * radius * Point(std::cos(turn - 0.785), std::sin(turn - 0.785));
      canvas_.polygon({centre, centre + side, tip}, kInk);
      canvas_.polygon({centre, centre + other, tip}, 0.95);
      canvas_.polyline({centre, centre + other, tip, centre + side, centre}, 1.0, kInk);
    }
    canvas_.disc(centre, 0.09 * radius, 0.95);
    canvas_.ring(centre, 0.09 * radius, 1.2, kInk);
  }

  void draw_title(const Point& corner) {
    const Point size(0.265 * canvas_.width(), 0.165 * canvas_.height());
    canvas_.box(corner, corner + size, 0.94);
    canvas_.frame(corner, corner + size, 2.4, kInk);
    canvas_.frame(corner + Point(5, 5), corner + size - Point(5, 5), 1.0, kInk);
    draw_word(canvas_, corner + Point(18, 17), 26.0, 0.0, 7, rng_);
    double x = corner.x() + 18.0;
    for (int word = 0; word < 4; ++word) {
      const int letters = 2 + static_cast<int>(rng_.below(4));
      draw_word(canvas_, {x, corner.y() + 56.0}, 10.0, 0.0, letters, rng_);
      x += 10.0 * (letters + 1);
    }
    x = corner.x() + 18.0;
    for (const double length : {16.0, 24.0, 40.0, 56.0}) {
      const bool dark = length == 16.0 || length == 40.0;
      canvas_.box({x, corner.y() + 78.0}, {x + length, corner.y() + 84.0}, dark ? kInk : 0.94);
      canvas_.frame({x, corner.y() + 78.0}, {x + length, corner.y() + 84.0}, 1.2, kInk);
      x += length;
    }
  }

  void draw_border() {
    const double w = canvas_.width() - 1.0, h = canvas_.height() - 1.0;
    const Point size(w, h);
    canvas_.box({-2, -2}, {w + 2, kMargin}, kPaper);
    canvas_.box({-2, h - kMargin}, {w + 2, h + 2}, kPaper);
    canvas_.box({-2, -2}, {kMargin, h + 2}, kPaper);
    canvas_.box({w - kMargin, -2}, {w + 2, h + 2}, kPaper);
    for (double x = kMargin; x < w - kMargin;) x = draw_tick(x, w - kMargin, true);
    for (double y = kMargin; y < h - kMargin;) y = draw_tick(y, h - kMargin, false);
    const Point inner = Point::Constant(kMargin), outer = Point::Constant(kMargin - 7.0);
    canvas_.frame(inner, size - inner, 1.6, kInk);
    canvas_.frame(outer, size - outer, 1.6, kInk);
  }

  /// A dark piece of the border on both sides, as long as it happens to be, with a number.
  double draw_tick(double start, double end, bool horizontal) {
    const double dark = std::min(end, start + rng_.uniform(10.0, 34.0));
    const double far = (horizontal ? canvas_.height() : canvas_.width()) - 1.0;
    for (const double side : {kMargin - 3.5, far - kMargin + 3.5}) {
      const Point low = horizontal ? Point(start, side - 3.5) : Point(side - 3.5, start);
      const Point high = horizontal ? Point(dark, side + 3.5) : Point(side + 3.5, dark);
      canvas_.box(low, high, kInk);
      const double edge = side < 0.5 * far ? 5.0 : far - 13.0;
      const Point text = horizontal ? Point(start, edge) : Point(edge, start);
      draw_word(canvas_, text, 8.0, 0.0, horizontal ? 2 : 1, rng_);
    }
    return dark + rng_.uniform(10.0, 34.0);
  }

  Rng rng_;
  Terrain terrain_;
  Canvas canvas_;
};

}  // namespace

Canvas draw_map(int width, int height, std::uint64_t seed) {
  return MapPainter(width, height, seed).paint();
}

}  // namespace weft::texture
