// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "lab/metrics/field.hpp"
#include "lab/statistics/unknown.hpp"

namespace weft::lab {

/// MotionMetrics over all triples of solved frames that follow each other without a cut.
struct Jitter {
  std::int64_t triples = 0, truth_triples = 0;  ///< [] triples of frames; with truth
  std::int64_t cuts = 0;                        ///< [] frames before which the truth jumps
  double mean_mm = kUnknown;                    ///< [] mm
  double median_mm = kUnknown;                  ///< [] mm, robust against cuts that the truth does
                                                ///< not mark
  double truth_mean_mm = kUnknown;              ///< [] mm

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit({"mean_mm", "mean |X_t - 2 X_(t-1) + X_(t-2)| over triples and vertices", kLower},
          self.mean_mm);
    visit({"median_mm", "median over the triples", kLower}, self.median_mm);
    visit({"triples", "of solved frames without a gap or cut"}, self.triples);
    visit({"truth_mean_mm", "the truth's own, over its points"}, self.truth_mean_mm);
    visit({"truth_triples", "of them, with truth at the same points"}, self.truth_triples);
    visit({"cuts", "frames before which the truth jumps"}, self.cuts);
  }
};

/// Means of ImageMetrics over solved frames.
struct ImageSummary {
  double match_tolerance_px = kUnknown;                         ///< [] px
  std::int64_t reprojection_frames = 0, overlay_frames = 0;     ///< [] frames in the means
  std::int64_t reprojection_matches = 0, overlay_vertices = 0;  ///< [] over these frames
  std::int64_t behind_camera_frames = 0;                        ///< [] without these figures
  double reprojection_px = kUnknown;                            ///< [] px
  double overlay_px = kUnknown;                                 ///< [] px
  double truth_map_px = kUnknown;                               ///< [] px, median over frames

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit({"match_tolerance_px", "a match this near its true place is correct"},
          self.match_tolerance_px);
    visit({"truth_map_px", "how well the truth predicts itself, median over frames", kLower},
          self.truth_map_px);
    visit({"reprojection_px", "mean distance of inliers to their projected estimate", kLower},
          self.reprojection_px);
    visit({"reprojection_frames", "number of these frames"}, self.reprojection_frames);
    visit({"reprojection_matches", "number of these inliers"}, self.reprojection_matches);
    visit({"overlay_px", "mean distance of projected vertices to their true images", kLower},
          self.overlay_px);
    visit({"overlay_frames", "number of these frames"}, self.overlay_frames);
    visit({"overlay_vertices", "number of these vertices"}, self.overlay_vertices);
    visit({"behind_camera_frames", "with a point behind the camera, without such numbers"},
          self.behind_camera_frames);
  }
};

/// DepthMetrics over solved frames with a depth image.
struct DepthSummary {
  std::int64_t frames = 0;                      ///< [] with a median
  std::int64_t frames_without_median = 0;       ///< [] the other frames
  std::int64_t matches = 0, without_depth = 0;  ///< [] matches over all frames
  double mean_mm = kUnknown;                    ///< [] mm, mean over frames of their medians
  double median_mm = kUnknown;                  ///< [] mm, median over frames of their medians
  double worst_mm = kUnknown;                   ///< [] mm, largest median of a frame

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit({"depth_median_mm", "mean over frames of the median distance to the depth image", kLower},
          self.mean_mm);
    visit({"depth_median_of_frames_mm", "median over frames of it", kLower}, self.median_mm);
    visit({"depth_median_worst_mm", "largest of a frame", kLower}, self.worst_mm);
    visit({"frames", "with a median"}, self.frames);
    visit({"frames_without_median", "solved, with a depth image, but without a median"},
          self.frames_without_median);
    visit({"matches", "kept, with a depth"}, self.matches);
    visit({"matches_without_depth", "kept, without one"}, self.without_depth);
  }
};

/// All frames, with truth or without. frames is the sum of the six that follow.
struct FrameCounts {
  std::int64_t frames = 0;  ///< [] all frames
  std::int64_t estimated = 0, weak = 0, predicted = 0, lost = 0, none = 0,
               invalid = 0;  ///< [] frames by state
  std::int64_t failed = 0;   ///< [] with an error somewhere; they are counted above too

  std::int64_t solved() const { return estimated + weak; }
  double solved_percent() const {
    return kPercent * (static_cast<double>(solved()) / static_cast<double>(frames));
  }

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit({"frames", "with truth or without"}, self.frames);
    visit.derived({"solved", "estimated or weak", kHigher}, self.solved());
    visit.derived({"solved_percent", "of all frames", kHigher}, self.solved_percent());
    visit({"estimated", "by the state of the shape"}, self.estimated);
    visit({"weak", "likewise"}, self.weak);
    visit({"predicted", "likewise"}, self.predicted);
    visit({"lost", "likewise"}, self.lost);
    visit({"none", "without a shape yet"}, self.none);
    visit({"invalid", "NaN or infinity in the shape", kLower}, self.invalid);
    visit({"failed", "with an error of a stage, the source or a sink; counted above too", kLower},
          self.failed);
  }
};

}  // namespace weft::lab
