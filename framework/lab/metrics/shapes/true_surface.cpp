// SPDX-License-Identifier: Apache-2.0
#include "lab/metrics/shapes/true_surface.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <weft/core/index.hpp>
#include <weft/core/rng.hpp>

namespace weft::lab {
namespace {

/// Adds the points of one kind that belong to the part, and the faces over them.
class Adder {
 public:
  Adder(TrueSurface& surface, std::optional<std::int32_t> part) : surface_(surface), part_(part) {}

  void add(const Array<double>& points, const Array<std::int32_t>& faces,
           const Array<std::int32_t>& part_of) {
    if (!points.present() || points.rows() == 0) return;
    const auto taken = [&](std::int64_t i) {
      return !part_ || (part_of.present() && part_of(i) == *part_);
    };
    std::vector<bool> is_corner(to_index(points.rows()), false);
    for (std::int64_t f = 0; faces.present() && f < faces.rows(); ++f) {
      const std::int32_t a = faces(f, 0), b = faces(f, 1), c = faces(f, 2);
      if (!taken(a) || !taken(b) || !taken(c)) continue;
      surface_.faces.push_back({at(points, a), at(points, b), at(points, c)});
      for (const std::int32_t corner : {a, b, c}) is_corner[to_index(corner)] = true;
    }
    for (std::int64_t i = 0; i < points.rows(); ++i) {
      if (!taken(i)) continue;
      surface_.points_m.push_back(at(points, i));
      if (!is_corner[to_index(i)]) surface_.loose_m.push_back(at(points, i));
    }
  }

 private:
  static Eigen::Vector3d at(const Array<double>& points, std::int64_t i) {
    return {points(i, 0), points(i, 1), points(i, 2)};
  }

  TrueSurface& surface_;
  std::optional<std::int32_t> part_;
};

}  // namespace

TrueSurface true_surface(const GroundTruth& truth, std::optional<std::int32_t> part) {
  TrueSurface surface;
  Adder adder(surface, part);
  adder.add(truth.points_m, truth.faces, truth.point_part);
  adder.add(truth.cloud_m, truth.cloud_faces, truth.cloud_part);
  return surface;
}

std::vector<Corners> corners_of(const Points3View& points, const FacesView& faces) {
  std::vector<Corners> corners;
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    corners.push_back({points.row(faces(f, 0)), points.row(faces(f, 1)), points.row(faces(f, 2))});
  }
  return corners;
}

double area_of(const Corners& corners) {
  return 0.5 * (corners[1] - corners[0]).cross(corners[2] - corners[0]).norm();
}

std::vector<Eigen::Vector3d> places_on(const std::vector<Corners>& triangles, std::int64_t count,
                                       std::uint64_t seed) {
  std::vector<double> area_up_to;
  double area_m2 = 0.0;
  for (const Corners& corners : triangles) area_up_to.push_back(area_m2 += area_of(corners));
  std::vector<Eigen::Vector3d> places;
  if (!(area_m2 > 0.0)) return places;
  Rng rng(seed);
  for (std::int64_t i = 0; i < count; ++i) {
    const auto drawn =
        std::upper_bound(area_up_to.begin(), area_up_to.end(), area_m2 * rng.uniform());
    const auto last = static_cast<std::ptrdiff_t>(triangles.size()) - 1;
    const auto& [a, b, c] = triangles[to_index(std::min(drawn - area_up_to.begin(), last))];
    // Even over the triangle: Osada et al. 2002, Shape Distributions.
    const double root = std::sqrt(rng.uniform()), share = rng.uniform();
    places.push_back((1.0 - root) * a + root * (1.0 - share) * b + root * share * c);
  }
  return places;
}

}  // namespace weft::lab
