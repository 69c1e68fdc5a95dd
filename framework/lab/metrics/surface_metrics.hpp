// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <weft/geometry/types.hpp>

#include "lab/metrics/field.hpp"
#include "lab/metrics/shapes/true_surface.hpp"
#include "lab/statistics/unknown.hpp"

namespace weft::lab {

/// The same distances as in the literature, which compares points. They are measured from the true
/// points to the nearest of the points sampled uniformly over the mesh. In the other direction they
/// are measured from these samples to the nearest true point. If the truth has faces, as many
/// points sampled over its surface replace the true points.
struct SampledDistances {
  double from_truth_mm = kUnknown, to_truth_mm = kUnknown;                    ///< [] mm
  double from_truth_squared_mm2 = kUnknown, to_truth_squared_mm2 = kUnknown;  ///< [] mm^2

  double chamfer_mm() const { return 0.5 * (from_truth_mm + to_truth_mm); }
  double chamfer_squared_mm2() const { return from_truth_squared_mm2 + to_truth_squared_mm2; }

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit({"sampled_from_truth_mm", "mean distance of true samples to the nearest of the mesh",
           kLower},
          self.from_truth_mm);
    visit({"sampled_to_truth_mm", "mean distance of the mesh's samples to the nearest true one",
           kLower},
          self.to_truth_mm);
    visit.derived({"sampled_chamfer_mm", "mean of these two", kLower}, self.chamfer_mm());
    visit({"sampled_from_truth_squared_mm2", "mean squared distance of true samples", kLower},
          self.from_truth_squared_mm2);
    visit({"sampled_to_truth_squared_mm2", "mean squared distance of the mesh's samples", kLower},
          self.to_truth_squared_mm2);
    visit.derived({"sampled_chamfer_squared_mm2", "sum of these two", kLower},
                  self.chamfer_squared_mm2());
  }
};

/// Distances between two surfaces without correspondences, for a solved frame. They are measured
/// from each point of the truth to the nearest point of the mesh. In the other direction they are
/// measured from points spread evenly over the mesh to the truth: its surface if it has one, else
/// its points. Never aligned.
struct SurfaceMetrics {
  double from_truth_mm = kUnknown;               ///< [] mm, mean over the true points
  double to_truth_mm = kUnknown;                 ///< [] mm, mean over the mesh's area
  double from_truth_squared_mm2 = kUnknown;      ///< [] mm^2, mean over the true points
  double to_truth_squared_mm2 = kUnknown;        ///< [] mm^2, mean over the mesh's area
  std::optional<SampledDistances> sampled = {};  ///< present on request

  double chamfer_mm() const { return 0.5 * (from_truth_mm + to_truth_mm); }
  double chamfer_squared_mm2() const { return from_truth_squared_mm2 + to_truth_squared_mm2; }

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit({"surface_from_truth_mm", "mean distance of true points to the mesh", kLower},
          self.from_truth_mm);
    visit({"surface_to_truth_mm", "mean distance of the mesh to the truth", kLower},
          self.to_truth_mm);
    visit.derived({"chamfer_mm", "mean of these two", kLower}, self.chamfer_mm());
    visit({"surface_from_truth_squared_mm2", "mean squared distance of true points to the mesh",
           kLower},
          self.from_truth_squared_mm2);
    visit(
        {"surface_to_truth_squared_mm2", "mean squared distance of the mesh to the truth", kLower},
        self.to_truth_squared_mm2);
    visit.derived({"chamfer_squared_mm2", "sum of these two", kLower}, self.chamfer_squared_mm2());
    visit.optional(self.sampled);
  }
};

/// Means of SampledDistances over the frames that have them.
struct SampledSummary {
  std::int64_t frames = 0;  ///< [] frames with distances
  double from_truth_mm = kUnknown, to_truth_mm = kUnknown, chamfer_mm = kUnknown;  ///< [] mm
  double from_truth_squared_mm2 = kUnknown, to_truth_squared_mm2 = kUnknown;       ///< [] mm^2
  double chamfer_squared_mm2 = kUnknown;                                           ///< [] mm^2

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit({"sampled_frames", "frames with sampled distances"}, self.frames);
    visit({"sampled_from_truth_mm", "mean distance of true samples to the nearest of the mesh",
           kLower},
          self.from_truth_mm);
    visit({"sampled_to_truth_mm", "mean distance of the mesh's samples to the nearest true one",
           kLower},
          self.to_truth_mm);
    visit({"sampled_chamfer_mm", "mean over frames of the mean of these two", kLower},
          self.chamfer_mm);
    visit({"sampled_from_truth_squared_mm2", "mean squared distance of true samples", kLower},
          self.from_truth_squared_mm2);
    visit({"sampled_to_truth_squared_mm2", "mean squared distance of the mesh's samples", kLower},
          self.to_truth_squared_mm2);
    visit({"sampled_chamfer_squared_mm2", "mean over frames of the sum of these two", kLower},
          self.chamfer_squared_mm2);
  }
};

/// Means of SurfaceMetrics over the frames that have them.
struct SurfaceSummary {
  std::int64_t frames = 0;            ///< [] solved, with true points
  std::int64_t frames_both_ways = 0;  ///< [] of them, with a truth that is dense enough
  double from_truth_mm = kUnknown, to_truth_mm = kUnknown;                    ///< [] mm
  double from_truth_squared_mm2 = kUnknown, to_truth_squared_mm2 = kUnknown;  ///< [] mm^2
  double chamfer_mm = kUnknown;                 ///< [] mm, of frames both ways
  double chamfer_squared_mm2 = kUnknown;        ///< [] mm^2, of frames both ways
  double worst_chamfer_squared_mm2 = kUnknown;  ///< [] mm^2, largest of a frame
  SampledSummary sampled;                       ///< present on request

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit({"frames", "solved, with true points"}, self.frames);
    visit({"frames_both_ways", "of them, with a truth that is dense enough"},
          self.frames_both_ways);
    visit({"surface_from_truth_mm", "mean distance of true points to the mesh", kLower},
          self.from_truth_mm);
    visit({"surface_to_truth_mm", "mean distance of the mesh to the truth", kLower},
          self.to_truth_mm);
    visit({"chamfer_mm", "mean over frames of the mean of these two", kLower}, self.chamfer_mm);
    visit({"surface_from_truth_squared_mm2", "mean squared distance of true points to the mesh",
           kLower},
          self.from_truth_squared_mm2);
    visit(
        {"surface_to_truth_squared_mm2", "mean squared distance of the mesh to the truth", kLower},
        self.to_truth_squared_mm2);
    visit({"chamfer_squared_mm2", "mean over frames of the sum of these two", kLower},
          self.chamfer_squared_mm2);
    visit({"chamfer_squared_worst_mm2", "largest sum of a frame", kLower},
          self.worst_chamfer_squared_mm2);
    SampledSummary::fields(self.sampled, visit);
  }
};

/// The number of points sampled on a surface for sampled distances, as in the literature.
inline constexpr std::int64_t kSurfaceSamples = 10'000;

/// Seeds of the samples, so that a run that is evaluated twice has the same figures.
inline constexpr std::uint64_t kMeshSeed = 1, kTruthSeed = 2;

/// For vertices [V,3] m, camera frame, all finite, and a truth with points. The distance from the
/// mesh needs a dense truth: one with faces, or with points closer than 1 % of the mesh's diagonal.
/// Sampled distances use `samples` points; with 0 there are none.
SurfaceMetrics surface_metrics(const Points3View& vertices_m, const FacesView& faces,
                               const TrueSurface& truth, std::int64_t samples = 0);

SurfaceSummary summarise_surfaces(std::span<const SurfaceMetrics> frames);

}  // namespace weft::lab
