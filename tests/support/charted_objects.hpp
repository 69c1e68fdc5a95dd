// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <vector>
#include <weft/data/template.hpp>

namespace weft::charted {

using Place = std::array<double, 3>;

/// Builds templates from rectangular charts, each with its own vertices.
class ChartBuilder {
 public:
  /// Adds a chart of columns x rows vertices; `place(i, j)` is the place in m of a vertex. Faces
  /// are counter-clockwise where i to the right and j upwards is seen from outside.
  void add(int columns, int rows, const std::function<Place(int, int)>& place) {
    const auto first = static_cast<std::int32_t>(places_m_.size());
    const double left_px = 10.0 + kPitchPx * static_cast<double>(charts_++) * (columns + 1);
    for (int j = 0; j < rows; ++j) {
      for (int i = 0; i < columns; ++i) {
        places_m_.push_back(place(i, j));
        flat_px_.push_back({left_px + kPitchPx * i, 10.0 + kPitchPx * (rows - 1 - j)});
      }
    }
    for (std::int32_t j = 0; j + 1 < rows; ++j) {
      for (std::int32_t i = 0; i + 1 < columns; ++i) {
        const std::int32_t a = first + j * columns + i, b = a + 1, c = b + columns, d = a + columns;
        faces_.push_back({a, b, c});
        faces_.push_back({a, c, d});
      }
    }
  }

  /// The template, with vertices at the same place welded.
  Template build() const {
    Template templ;
    const auto count = static_cast<std::int64_t>(places_m_.size());
    templ.vertices_m = Array<double>({count, 3});
    templ.flat_px = Array<double>({count, 2});
    templ.welded_vertex = Array<std::int32_t>({count});
    for (std::int64_t v = 0; v < count; ++v) {
      const Place& place = places_m_[static_cast<std::size_t>(v)];
      for (std::size_t k = 0; k < 3; ++k)
        templ.vertices_m(v, static_cast<std::int64_t>(k)) = place[k];
      templ.flat_px(v, 0) = flat_px_[static_cast<std::size_t>(v)][0];
      templ.flat_px(v, 1) = flat_px_[static_cast<std::size_t>(v)][1];
      std::int32_t first = 0;
      while (!same(places_m_[static_cast<std::size_t>(first)], place)) ++first;
      templ.welded_vertex(v) = first;
    }
    templ.faces = Array<std::int32_t>({static_cast<std::int64_t>(faces_.size()), 3});
    for (std::size_t f = 0; f < faces_.size(); ++f) {
      for (std::size_t k = 0; k < 3; ++k) {
        templ.faces(static_cast<std::int64_t>(f), static_cast<std::int64_t>(k)) = faces_[f][k];
      }
    }
    templ.m_per_px = Array<double>({2}, 0.001);
    templ.texture = Array<std::uint8_t>({200, 1000}, 128);
    templ.mask = Array<std::uint8_t>({200, 1000}, 1);
    return templ;
  }

 private:
  static constexpr double kPitchPx = 10.0;

  static bool same(const Place& a, const Place& b) {
    return std::abs(a[0] - b[0]) + std::abs(a[1] - b[1]) + std::abs(a[2] - b[2]) < 1e-9;
  }

  int charts_ = 0;
  std::vector<Place> places_m_;
  std::vector<std::array<double, 2>> flat_px_;
  std::vector<std::array<std::int32_t, 3>> faces_;
};

/// A cube of 0.1 m around the origin with six charts of n x n vertices.
inline Template charted_cube(int n) {
  ChartBuilder builder;
  const double half_m = 0.05;
  for (int axis = 0; axis < 3; ++axis) {
    for (const int sign : {-1, 1}) {
      builder.add(n, n, [&](int i, int j) {
        const double a = half_m * (2.0 * i / (n - 1) - 1.0), b = half_m * (2.0 * j / (n - 1) - 1.0);
        Place place{};
        place[static_cast<std::size_t>(axis)] = sign * half_m;
        place[static_cast<std::size_t>((axis + 1) % 3)] = sign > 0 ? a : b;
        place[static_cast<std::size_t>((axis + 2) % 3)] = sign > 0 ? b : a;
        return place;
      });
    }
  }
  return builder.build();
}

/// A cylinder around y of radius 0.05 m, open at its ends, with two charts of half a turn each:
/// `steps` faces around and `rows` vertices along the axis.
inline Template charted_cylinder(int steps, int rows) {
  ChartBuilder builder;
  for (const int side : {0, 1}) {
    builder.add(steps + 1, rows, [&](int i, int j) {
      const double angle_rad = std::numbers::pi * (side + static_cast<double>(i) / steps);
      return Place{0.05 * std::cos(angle_rad), 0.02 * j, -0.05 * std::sin(angle_rad)};
    });
  }
  return builder.build();
}

}  // namespace weft::charted
