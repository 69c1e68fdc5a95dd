// SPDX-License-Identifier: Apache-2.0
#include "lab/metrics/surface_metrics.hpp"

#include <cmath>
#include <utility>
#include <vector>
#include <weft/core/statistics.hpp>

namespace weft::lab {
namespace {

/// Each side of a face of the mesh is cut into this number of parts, which gives triangles of equal
/// area.
constexpr int kCuts = 4;
constexpr double kDense = 0.01;  // share of the diagonal of the mesh

/// Sums of distances and of their squares, in mm.
struct Sums {
  double weight = 0.0, distance = 0.0, square = 0.0;

  void add(double share, double distance_m) {
    const double mm = kMmPerM * distance_m;
    weight += share;
    distance += share * mm;
    square += share * mm * mm;
  }
};

/// Calls visit(place) for the middle of each of the triangles into which a face is cut.
template <class Visit>
void for_each_place(const Corners& corners, Visit&& visit) {
  const auto at = [&](double along_ab, double along_ac) {
    return Eigen::Vector3d(corners[0] + along_ab / kCuts * (corners[1] - corners[0]) +
                           along_ac / kCuts * (corners[2] - corners[0]));
  };
  constexpr double kThird = 1.0 / 3.0;
  for (int i = 0; i < kCuts; ++i) {
    for (int j = 0; i + j < kCuts; ++j) {
      visit(at(i + kThird, j + kThird));
      if (i + j + 1 < kCuts) visit(at(i + 2.0 * kThird, j + 2.0 * kThird));
    }
  }
}

/// Writes the means of both ways into members of the same names; the second where it is known.
template <class Distances>
void take(const Sums& from, const Sums& to, Distances& distances) {
  distances.from_truth_mm = from.distance / from.weight;
  distances.from_truth_squared_mm2 = from.square / from.weight;
  if (!(to.weight > 0.0)) return;
  distances.to_truth_mm = to.distance / to.weight;
  distances.to_truth_squared_mm2 = to.square / to.weight;
}

Sums sums_between(const std::vector<Eigen::Vector3d>& points, const NearestPoint& nearest) {
  Sums sums;
  for (const Eigen::Vector3d& point : points) sums.add(1.0, nearest.distance(point));
  return sums;
}

std::optional<SampledDistances> sampled(const std::vector<Corners>& mesh, const TrueSurface& truth,
                                        bool dense, std::int64_t samples) {
  const std::vector<Eigen::Vector3d> places = places_on(mesh, samples, kMeshSeed);
  if (places.empty()) return std::nullopt;
  std::vector<Eigen::Vector3d> true_places = places_on(truth.faces, samples, kTruthSeed);
  const std::vector<Eigen::Vector3d>& alone = true_places.empty() ? truth.points_m : truth.loose_m;
  true_places.insert(true_places.end(), alone.begin(), alone.end());
  SampledDistances distances;
  const Sums from = sums_between(true_places, NearestPoint(places));
  take(from, dense ? sums_between(places, NearestPoint(true_places)) : Sums{}, distances);
  return distances;
}

SampledSummary summarise_sampled(std::span<const SurfaceMetrics> frames) {
  SampledSummary summary;
  const auto mean_of = [&](auto&& value_of) {
    std::vector<double> values;
    for (const SurfaceMetrics& frame : frames) {
      const double value = frame.sampled ? value_of(*frame.sampled) : kUnknown;
      if (std::isfinite(value)) values.push_back(value);
    }
    return mean_or_unknown(values);
  };
  for (const SurfaceMetrics& frame : frames) summary.frames += frame.sampled.has_value();
  summary.from_truth_mm = mean_of([](const auto& each) { return each.from_truth_mm; });
  summary.to_truth_mm = mean_of([](const auto& each) { return each.to_truth_mm; });
  summary.chamfer_mm = mean_of([](const auto& each) { return each.chamfer_mm(); });
  summary.from_truth_squared_mm2 =
      mean_of([](const auto& each) { return each.from_truth_squared_mm2; });
  summary.to_truth_squared_mm2 =
      mean_of([](const auto& each) { return each.to_truth_squared_mm2; });
  summary.chamfer_squared_mm2 =
      mean_of([](const auto& each) { return each.chamfer_squared_mm2(); });
  return summary;
}

}  // namespace

SurfaceMetrics surface_metrics(const Points3View& vertices_m, const FacesView& faces,
                               const TrueSurface& truth, std::int64_t samples) {
  const std::vector<Corners> triangles = corners_of(vertices_m, faces);
  double area_m2 = 0.0;
  for (const Corners& corners : triangles) area_m2 += area_of(corners);
  const double diagonal_m =
      (vertices_m.colwise().maxCoeff() - vertices_m.colwise().minCoeff()).norm();
  const double spacing_m = std::sqrt(area_m2 / static_cast<double>(truth.points_m.size()));
  const bool dense = !truth.faces.empty() || spacing_m <= kDense * diagonal_m;
  Sums from, to;
  const NearestPlace mesh(triangles);
  for (const Eigen::Vector3d& point : truth.points_m) from.add(1.0, mesh.distance(point));
  if (dense) {
    std::vector<Corners> truly = truth.faces;
    for (const Eigen::Vector3d& point : truth.loose_m) truly.push_back({point, point, point});
    const NearestPlace nearest(std::move(truly));
    for (const Corners& corners : triangles) {
      for_each_place(corners, [&](const Eigen::Vector3d& place) {
        to.add(area_of(corners), nearest.distance(place));
      });
    }
  }
  SurfaceMetrics metrics;
  take(from, to, metrics);
  if (samples > 0) metrics.sampled = sampled(triangles, truth, dense, samples);
  return metrics;
}

SurfaceSummary summarise_surfaces(std::span<const SurfaceMetrics> frames) {
  const auto known = [&](auto&& value_of) {
    std::vector<double> values;
    for (const SurfaceMetrics& frame : frames) {
      if (const double value = value_of(frame); std::isfinite(value)) values.push_back(value);
    }
    return values;
  };
  const auto mean_of = [&](auto&& value_of) { return mean_or_unknown(known(value_of)); };
  SurfaceSummary summary;
  summary.frames = static_cast<std::int64_t>(frames.size());
  summary.from_truth_mm = mean_of([](const auto& frame) { return frame.from_truth_mm; });
  summary.to_truth_mm = mean_of([](const auto& frame) { return frame.to_truth_mm; });
  summary.from_truth_squared_mm2 =
      mean_of([](const auto& frame) { return frame.from_truth_squared_mm2; });
  summary.to_truth_squared_mm2 =
      mean_of([](const auto& frame) { return frame.to_truth_squared_mm2; });
  summary.chamfer_mm = mean_of([](const auto& frame) { return frame.chamfer_mm(); });
  const std::vector<double> sums_mm2 =
      known([](const auto& frame) { return frame.chamfer_squared_mm2(); });
  summary.frames_both_ways = static_cast<std::int64_t>(sums_mm2.size());
  summary.chamfer_squared_mm2 = mean_or_unknown(sums_mm2);
  summary.worst_chamfer_squared_mm2 = percentile(sums_mm2, 100.0);
  summary.sampled = summarise_sampled(frames);
  return summary;
}

}  // namespace weft::lab
