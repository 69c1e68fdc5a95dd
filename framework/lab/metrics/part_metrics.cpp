// SPDX-License-Identifier: Apache-2.0
#include "lab/metrics/part_metrics.hpp"

#include <algorithm>
#include <cmath>
#include <weft/core/index.hpp>
#include <weft/core/statistics.hpp>

namespace weft::lab {

FrameParts frame_parts(const Points3View& vertices_m, const FacesView& faces,
                       const GroundTruth& truth, std::int64_t samples) {
  FrameParts parts;
  const std::vector<std::string> names = truth.parts();
  for (std::size_t i = 0; i < names.size(); ++i) {
    const TrueSurface surface = true_surface(truth, static_cast<std::int32_t>(i));
    if (surface.points_m.empty()) continue;
    FramePart part;
    part.surface = surface_metrics(vertices_m, faces, surface, samples);
    parts.emplace_back(names[i], part);
  }
  return parts;
}

void add_errors(const PointErrors& errors, const GroundTruth& truth, FrameParts& parts) {
  if (!truth.point_part.present()) return;
  const std::vector<std::string> names = truth.parts();
  for (auto& [name, part] : parts) {
    const auto index = std::find(names.begin(), names.end(), name) - names.begin();
    std::vector<double> mm;
    for (std::size_t i = 0; i < errors.points.size(); ++i) {
      if (truth.point_part(errors.points[i]) != index) continue;
      mm.push_back(kMmPerM * errors.distances_m[i]);
    }
    part.points = static_cast<std::int64_t>(mm.size());
    part.mean_mm = mean_or_unknown(mm);
  }
}

std::vector<PartMetrics> summarise_parts(
    const std::vector<std::pair<std::string, std::vector<FramePart>>>& parts) {
  std::vector<PartMetrics> summaries;
  for (const auto& [name, frames] : parts) {
    PartMetrics& summary = summaries.emplace_back();
    summary.part = name;
    summary.frames = static_cast<std::int64_t>(frames.size());
    std::vector<double> means_mm;
    std::vector<SurfaceMetrics> surfaces;
    for (const FramePart& frame : frames) {
      summary.points += frame.points;
      if (std::isfinite(frame.mean_mm)) means_mm.push_back(frame.mean_mm);
      if (frame.surface) surfaces.push_back(*frame.surface);
    }
    summary.mean_mm = mean_or_unknown(means_mm);
    summary.worst_mm = percentile(means_mm, 100.0);
    summary.surface = summarise_surfaces(surfaces);
  }
  return summaries;
}

}  // namespace weft::lab
