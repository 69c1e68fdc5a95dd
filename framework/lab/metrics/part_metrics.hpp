// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>
#include <weft/data/ground_truth.hpp>

#include "lab/metrics/shapes/shape_meter.hpp"
#include "lab/metrics/surface_metrics.hpp"

namespace weft::lab {

/// A part of the truth of a solved frame, scored as though there were no other.
struct FramePart {
  std::int64_t points = 0;                ///< [] true points with an error
  double mean_mm = kUnknown;              ///< [] mm, mean 3D error of these
  std::optional<SurfaceMetrics> surface;  ///< where the part has points or a cloud

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit({"points", "of the part, with a 3D error"}, self.points);
    visit({"mean_mm", "mean 3D error of these", kLower}, self.mean_mm);
    visit.optional(self.surface);
  }
};

/// A part over the solved frames whose truth has it.
struct PartMetrics {
  std::string part;
  std::int64_t frames = 0;     ///< [] solved, whose truth has the part
  std::int64_t points = 0;     ///< [] true points with an error
  double mean_mm = kUnknown;   ///< [] mm, mean over frames of their mean 3D errors
  double worst_mm = kUnknown;  ///< [] mm, largest of these means
  SurfaceSummary surface;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit({"part", "of the truth"}, self.part);
    visit({"frames", "solved, whose truth has the part", {}, "frames"}, self.frames);
    visit({"points", "of the part, with a 3D error", {}, "points"}, self.points);
    visit({"mean_mm", "mean over frames of the mean 3D error of these", kLower, "3D error mm"},
          self.mean_mm);
    visit({"worst_mm", "largest of these means", kLower, "worst mm"}, self.worst_mm);
    visit({"surface", "mesh and part as surfaces"}, self.surface);
  }
};

using FrameParts = std::vector<std::pair<std::string, FramePart>>;

/// The parts of a truth that have points or a cloud, by their names. Each has the surface distance
/// between the shape's vertices [V,3] m and the part; none if the truth has no parts.
FrameParts frame_parts(const Points3View& vertices_m, const FacesView& faces,
                       const GroundTruth& truth, std::int64_t samples);

/// Adds the 3D errors of the parts' points.
void add_errors(const PointErrors& errors, const GroundTruth& truth, FrameParts& parts);

/// In the order in which the parts are first met.
std::vector<PartMetrics> summarise_parts(
    const std::vector<std::pair<std::string, std::vector<FramePart>>>& parts);

}  // namespace weft::lab
