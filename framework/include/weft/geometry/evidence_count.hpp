// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/data/camera.hpp>
#include <weft/data/correspondences.hpp>
#include <weft/data/sightlines.hpp>
#include <weft/data/template.hpp>
#include <weft/geometry/object_box.hpp>

namespace weft {

/// Agreeing measurements that a shape needs to be `estimated`.
inline constexpr int kNeededMatches = 30, kNeededSightlines = 8;

/// Evidence for a shape: measurements in a frame and the part that the shape explains.
struct ShapeEvidence {
  int kept = 0;           ///< [] matches kept by filters; sightlines if no matches are connected
  int agreeing = 0;       ///< [] kept measurements within 3 px of the shape
  double coverage = 0.0;  ///< [] 0 to 1, share of the visible surface near agreeing measurements
  int needed = 0;         ///< [] agreeing ones: 30 matches, 8 sightlines; 0 if neither is connected
};

/// Memory of a count. A later count that gets it allocates nothing.
struct EvidenceMemory {
  std::vector<std::array<double, 2>> pixels;  ///< [V]
  std::vector<SurfaceCells::Cell> cells;
  std::vector<std::uint8_t> is_front_face;    ///< [F] only where faces turn away
  std::vector<std::uint8_t> is_front_vertex;  ///< [V] only where faces turn away
};

/// Gathers the evidence for one shape. Coverage is counted in square texture cells, twelve along
/// the template's diagonal, independent of the mesh. A cell counts if a corner or the centre of a
/// front face in the image lies in it. Coverage is the share of these cells with an agreeing match.
///
/// If some faces of the template turn away from others at rest, neighbours in the texture can be on
/// opposite sides of the object. The cells are then cubes around the surface at rest, and only
/// matches in front faces agree: what faces away from the camera is neither required nor evidence.
///
/// Vertices are any [V,3] with operator()(i, j): an array or a matrix. The header does not include
/// Eigen, because all solvers read it.
template <class Vertices>
class EvidenceCount {
  using Place2 = std::array<double, 2>;
  using Place3 = std::array<double, 3>;

 public:
  /// `vertices_m` [V,3] m, camera frame, are the template's vertices. All arguments must outlive
  /// the object.
  EvidenceCount(const Template& templ, const Camera& camera, const Vertices& vertices_m,
                EvidenceMemory memory = {})
      : memory_(std::move(memory)),
        cells_(templ, memory_.cells),
        faces_(templ.faces),
        camera_(camera),
        vertices_m_(vertices_m) {
    mark_seen();
  }
  EvidenceCount(const EvidenceCount&) = delete;
  EvidenceCount& operator=(const EvidenceCount&) = delete;

  /// Ends the count.
  EvidenceMemory take_memory() { return std::move(memory_); }

  ShapeEvidence of(const Correspondences& matches) {
    evidence_.needed = kNeededMatches;
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
    evidence_.needed = kNeededSightlines;
    for (std::int64_t i = 0; i < lines.count(); ++i) {
      if (lines.weight(i) == 0.0) continue;
      ++evidence_.kept;
      const Place2 seen_px = row<2>(lines.pixel_px, i);
      if (lines.vertex(i) >= 0) {
        const std::int32_t vertex = lines.vertex(i);
        if (cells_.are_at_rest() && !memory_.is_front_vertex[to_index(vertex)]) continue;
        add_place(row<3>(vertices_m_, vertex), cells_.place_of(vertex), seen_px);
      } else {
        add(lines.face(i), row<3>(lines.barycentrics, i), seen_px);
      }
    }
    return counted();
  }

 private:
  static constexpr double kAgreeingPx = 3.0;

  template <std::size_t Columns, class Rows>
  static std::array<double, Columns> row(const Rows& rows, std::int64_t i) {
    std::array<double, Columns> values;
    for (std::size_t j = 0; j < Columns; ++j) values[j] = rows(i, static_cast<std::int64_t>(j));
    return values;
  }

  static double length(double x, double y) { return std::sqrt(x * x + y * y); }

  /// The pixel of a point in m, camera frame; NaN unless it is in front of the camera.
  Place2 pixel_of(const Place3& point_m) const {
    if (!(point_m[2] > 0.0)) {
      constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
      return {kNone, kNone};
    }
    return {camera_.fx * point_m[0] / point_m[2] + camera_.cx,
            camera_.fy * point_m[1] / point_m[2] + camera_.cy};
  }

  /// The weighted mean of three values.
  static Place3 mean(const Place3& a, const Place3& b, const Place3& c, const Place3& weights) {
    Place3 sum;
    for (std::size_t j = 0; j < 3; ++j) {
      sum[j] = weights[0] * a[j] + weights[1] * b[j] + weights[2] * c[j];
    }
    return sum;
  }

  /// Front faces are counter-clockwise in the camera image; v points down.
  void mark_seen() {
    std::vector<Place2>& pixels = memory_.pixels;
    pixels.resize(to_index(vertices_m_.rows()));
    for (std::size_t v = 0; v < pixels.size(); ++v) {
      pixels[v] = pixel_of(row<3>(vertices_m_, static_cast<std::int64_t>(v)));
    }
    if (cells_.are_at_rest()) {
      memory_.is_front_face.assign(to_index(faces_.rows()), 0);
      memory_.is_front_vertex.assign(pixels.size(), 0);
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
      if (cells_.are_at_rest() && front) {
        memory_.is_front_face[to_index(f)] = 1;
        for (const std::int32_t v : corners) memory_.is_front_vertex[to_index(v)] = 1;
      }
      if (front && camera_.shows(centre(0), centre(1))) mark_face(corners);
    }
  }

  void mark_face(const std::array<std::int32_t, 3>& corners) {
    const std::array places{cells_.place_of(corners[0]), cells_.place_of(corners[1]),
                            cells_.place_of(corners[2])};
    Place3 middle{};
    for (const Place3& corner : places) {
      cells_.see(corner);
      for (std::size_t axis = 0; axis < 3; ++axis) middle[axis] += corner[axis] / 3.0;
    }
    cells_.see(middle);
  }

  void add(std::int32_t face, const Place3& weights, const Place2& seen_px) {
    if (face < 0 || (cells_.are_at_rest() && !memory_.is_front_face[to_index(face)])) return;
    const std::int32_t a = faces_(face, 0), b = faces_(face, 1), c = faces_(face, 2);
    add_place(mean(row<3>(vertices_m_, a), row<3>(vertices_m_, b), row<3>(vertices_m_, c), weights),
              mean(cells_.place_of(a), cells_.place_of(b), cells_.place_of(c), weights), seen_px);
  }

  void add_place(const Place3& point_m, const Place3& place, const Place2& seen_px) {
    const Place2 pixel = pixel_of(point_m);
    if (!(length(pixel[0] - seen_px[0], pixel[1] - seen_px[1]) < kAgreeingPx)) return;
    ++evidence_.agreeing;
    cells_.show(place);
  }

  ShapeEvidence counted() {
    evidence_.coverage = cells_.share_shown();
    return evidence_;
  }

  EvidenceMemory memory_;
  SurfaceCells cells_;  ///< in memory_
  const Array<std::int32_t>& faces_;
  const Camera& camera_;
  const Vertices& vertices_m_;
  ShapeEvidence evidence_;
};

}  // namespace weft
