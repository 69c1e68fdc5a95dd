// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/data/camera.hpp>
#include <weft/data/correspondences.hpp>
#include <weft/data/sightlines.hpp>
#include <weft/data/template.hpp>

namespace weft {

/// Evidence for a shape: measurements in a frame and the part that the shape explains.
struct ShapeEvidence {
  int kept = 0;           ///< [] matches kept by filters; sightlines if no matches are connected
  int agreeing = 0;       ///< [] kept measurements within 3 px of the shape
  double coverage = 0.0;  ///< [] 0 to 1, share of the visible surface near agreeing measurements
  int needed =
      0;  ///< [] required agreeing count: 30 matches, 8 sightlines; 0 if neither is connected
};

/// Gathers the evidence for one shape. Coverage is counted in square texture cells, twelve along
/// the template's diagonal, independent of the mesh. A cell counts if a corner or the centre of a
/// front face in the image lies in it. Coverage is the share of these cells with an agreeing match.
/// Vertices are any [V,3] with operator()(i, j): an array or a matrix. The header does not include
/// Eigen, because all solvers read it.
template <class Vertices>
class EvidenceCount {
  using Place2 = std::array<double, 2>;
  using Place3 = std::array<double, 3>;

 public:
  /// `vertices_m` [V,3] m, camera frame, are the template's vertices. All arguments must outlive
  /// the object.
  EvidenceCount(const Template& templ, const Camera& camera, const Vertices& vertices_m)
      : faces_(templ.faces), flat_px_(templ.flat_px), camera_(camera), vertices_m_(vertices_m) {
    Place2 high_px{};
    for (std::int64_t v = 0; v < flat_px_.rows(); ++v) {
      for (const int axis : {0, 1}) {
        double& low = low_px_[to_index(axis)];
        double& high = high_px[to_index(axis)];
        low = v == 0 ? flat_px_(v, axis) : std::min(low, flat_px_(v, axis));
        high = v == 0 ? flat_px_(v, axis) : std::max(high, flat_px_(v, axis));
      }
    }
    const Place2 size_px{high_px[0] - low_px_[0], high_px[1] - low_px_[1]};
    cell_px_ = std::max(length(size_px[0], size_px[1]) / kCellsAlongDiagonal, 1e-9);
    columns_ = cell_along(size_px[0]) + 1;
    cells_.assign(to_index(columns_ * (cell_along(size_px[1]) + 1)), kNothing);
    mark_seen();
  }

  ShapeEvidence of(const Correspondences& matches) {
    evidence_.needed = 30;
    for (std::int64_t i = 0; i < matches.count(); ++i) {
      if (matches.kept(i) == 0) continue;
      ++evidence_.kept;
      if (matches.face(i) < 0) continue;
      add(matches.face(i), row<3>(matches.barycentrics, i), row<2>(matches.image_px, i));
    }
    return counted();
  }

  /// Evidence from the sightlines of positive weight, if no matches are connected.
  ShapeEvidence of(const Sightlines& lines) {
    evidence_.needed = 8;
    for (std::int64_t i = 0; i < lines.count(); ++i) {
      if (lines.weight(i) == 0.0) continue;
      ++evidence_.kept;
      const Place2 seen_px = row<2>(lines.pixel_px, i);
      if (lines.vertex(i) >= 0) {
        const std::int32_t vertex = lines.vertex(i);
        add_place(row<3>(vertices_m_, vertex), row<2>(flat_px_, vertex), seen_px);
      } else {
        add(lines.face(i), row<3>(lines.barycentrics, i), seen_px);
      }
    }
    return counted();
  }

 private:
  static constexpr double kAgreeingPx = 3.0, kCellsAlongDiagonal = 12.0;
  enum Cell : std::uint8_t { kNothing = 0, kSeen = 1, kShown = 2 };

  template <std::size_t Columns, class Rows>
  static std::array<double, Columns> row(const Rows& rows, std::int64_t i) {
    std::array<double, Columns> values;
    for (std::size_t j = 0; j < Columns; ++j) values[j] = rows(i, static_cast<std::int64_t>(j));
    return values;
  }

  static double length(double x, double y) { return std::sqrt(x * x + y * y); }

  std::int64_t cell_along(double from_start_px) const {
    return static_cast<std::int64_t>(from_start_px / cell_px_);
  }

  /// The pixel of a point in m, camera frame; NaN unless it is in front of the camera.
  Place2 pixel_of(const Place3& point_m) const {
    if (!(point_m[2] > 0.0)) {
      constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
      return {kNone, kNone};
    }
    return {camera_.fx * point_m[0] / point_m[2] + camera_.cx,
            camera_.fy * point_m[1] / point_m[2] + camera_.cy};
  }

  /// The weighted mean of the values at a face's vertices.
  template <std::size_t Columns, class Rows>
  std::array<double, Columns> mean(const Rows& rows, std::int32_t face,
                                   const Place3& weights) const {
    const auto a = row<Columns>(rows, faces_(face, 0)), b = row<Columns>(rows, faces_(face, 1)),
               c = row<Columns>(rows, faces_(face, 2));
    std::array<double, Columns> sum;
    for (std::size_t j = 0; j < Columns; ++j) {
      sum[j] = weights[0] * a[j] + weights[1] * b[j] + weights[2] * c[j];
    }
    return sum;
  }

  void mark(const Place2& place_px, Cell before, Cell after) {
    const std::int64_t index =
        cell_along(place_px[1] - low_px_[1]) * columns_ + cell_along(place_px[0] - low_px_[0]);
    if (index < 0 || index >= static_cast<std::int64_t>(cells_.size())) return;
    Cell& cell = cells_[to_index(index)];
    if (cell == before) cell = after;
  }

  /// Front faces are counter-clockwise in the camera image; v points down.
  void mark_seen() {
    std::vector<Place2> pixels(to_index(vertices_m_.rows()));
    for (std::size_t v = 0; v < pixels.size(); ++v) {
      pixels[v] = pixel_of(row<3>(vertices_m_, static_cast<std::int64_t>(v)));
    }
    for (std::int64_t f = 0; f < faces_.rows(); ++f) {
      const std::array corners{faces_(f, 0), faces_(f, 1), faces_(f, 2)};
      const Place2& a = pixels[to_index(corners[0])];
      const Place2& b = pixels[to_index(corners[1])];
      const Place2& c = pixels[to_index(corners[2])];
      const bool front =
          (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) < 0.0;  // false for NaN
      const auto centre = [&](std::size_t axis) {
        return a[axis] + (b[axis] - a[axis] + (c[axis] - a[axis])) / 3.0;
      };
      if (!front || !camera_.shows(centre(0), centre(1))) continue;
      Place2 middle_px{};
      for (const std::int32_t v : corners) {
        const Place2 corner_px = row<2>(flat_px_, v);
        mark(corner_px, kNothing, kSeen);
        for (const std::size_t axis : {0U, 1U}) middle_px[axis] += corner_px[axis] / 3.0;
      }
      mark(middle_px, kNothing, kSeen);
    }
  }

  void add(std::int32_t face, const Place3& weights, const Place2& seen_px) {
    if (face < 0) return;
    add_place(mean<3>(vertices_m_, face, weights), mean<2>(flat_px_, face, weights), seen_px);
  }

  void add_place(const Place3& place_m, const Place2& place_px, const Place2& seen_px) {
    const Place2 pixel = pixel_of(place_m);
    if (!(length(pixel[0] - seen_px[0], pixel[1] - seen_px[1]) < kAgreeingPx)) return;
    ++evidence_.agreeing;
    mark(place_px, kSeen, kShown);
  }

  ShapeEvidence counted() {
    const auto shown = std::count(cells_.begin(), cells_.end(), kShown);
    const auto empty = std::count(cells_.begin(), cells_.end(), kNothing);
    const auto all = static_cast<std::int64_t>(cells_.size()) - empty;
    evidence_.coverage = all == 0 ? 0.0 : static_cast<double>(shown) / static_cast<double>(all);
    return evidence_;
  }

  const Array<std::int32_t>& faces_;
  const Array<double>& flat_px_;
  const Camera& camera_;
  const Vertices& vertices_m_;
  Place2 low_px_{};
  double cell_px_ = 1.0;
  std::int64_t columns_ = 1;
  std::vector<Cell> cells_;
  ShapeEvidence evidence_;
};

}  // namespace weft
