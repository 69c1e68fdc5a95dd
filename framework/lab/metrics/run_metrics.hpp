// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "lab/metrics/frame_metrics.hpp"
#include "lab/metrics/run_summaries.hpp"
#include "lab/metrics/shapes/alignment.hpp"
#include "lab/metrics/truth_metrics.hpp"

namespace weft::lab {

struct RunMetrics {
  std::string run;  ///< name of the folder
  Alignment alignment = Alignment::none;
  bool has_solver = true;           ///< without one there are no shapes, no groups and no failures
  bool interrupted = false;         ///< the run was killed while it wrote a frame's line
  std::int64_t source_frames = -1;  ///< frames of the source; -1 if unknown
  std::int64_t dropped = 0;  ///< [frames] of the source that a run of `realtime: latest` omitted
  std::vector<std::string> truth_users;  ///< components that may have read the truth
  /// Solvers, warps and filters that state it: "filters/tran: reconstruction".
  std::vector<std::string> implements;
  FrameCounts counts;
  double strain_mean = kUnknown;       ///< [] mean over all solved frames
  double strain_p95 = kUnknown;        ///< [] mean over them of the 95th percentile
  std::vector<GroupMetrics> groups;    ///< by kind, then reason; kinds without a reason first
  TruthMetrics all;                    ///< every frame with truth that is not excluded
  ImageSummary image;                  ///< without excluded frames
  DepthSummary depth;                  ///< without excluded frames
  SurfaceSummary surface;              ///< without excluded frames
  std::vector<PartMetrics> parts;      ///< parts of the truth; without excluded frames
  VisibilityMetrics visibility;        ///< without excluded frames
  RegistrationMetrics registration;    ///< without excluded frames
  CertaintyMetrics certainty;          ///< without excluded frames
  std::vector<FilterMetrics> filters;  ///< by stage; without excluded frames
  std::vector<WarpMetrics> warps;      ///< by stage; without excluded frames
  Jitter jitter;
  std::vector<FrameMetrics> frames;   ///< in order
  std::vector<std::string> warnings;  ///< omitted or unknown parts of the run folder, with reasons

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit({"run", "name of the run folder, or key of the cell"}, self.run);
    visit({"alignment", "what was taken out of the 3D errors: none, scale or rigid"},
          self.alignment);
    visit({"has_solver", "without one there are no shapes"}, self.has_solver);
    visit({"interrupted", "the run was killed while it wrote a frame's line"}, self.interrupted);
    visit({"dropped", "frames of the source that a run with `realtime: latest` skipped"},
          self.dropped);
    visit({"truth_users", "components that may have read the truth"}, self.truth_users);
    visit({"implements", "solvers, warps and filters: paper, reconstruction or own"},
          self.implements);
    visit({"counts", "all frames, with truth or without"}, self.counts);
    visit({"isometry_error_percent", "mean over all solved frames of |l / l0 - 1|", kLower, nullptr,
           2, kPercent},
          self.strain_mean);
    visit({"isometry_error_p95_percent", "mean over all solved frames of its 95th percentile",
           kLower, nullptr, 2, kPercent},
          self.strain_p95);
    visit({"groups", "frames by the kind of their truth, and by why they are excluded"},
          self.groups);
    visit({"all", "every frame with truth that is not excluded"}, self.all);
    visit({"image", "errors in the image, of solved frames"}, self.image);
    visit({"depth", "against depth images"}, self.depth);
    visit({"surface", "mesh and truth as surfaces"}, self.surface);
    visit({"parts", "parts of the truth, by their names"}, self.parts);
    visit({"visibility", "what the camera sees"}, self.visibility);
    visit({"registration", "the unwarped image against the flat reference"}, self.registration);
    visit({"certainty", "how sure the shapes are"}, self.certainty);
    visit({"filters", "by the name of the stage"}, self.filters);
    visit({"warps", "by the name of the stage"}, self.warps);
    visit({"jitter", "how the shapes tremble"}, self.jitter);
    visit({"frames", "one by one"}, self.frames);
  }
};

}  // namespace weft::lab
