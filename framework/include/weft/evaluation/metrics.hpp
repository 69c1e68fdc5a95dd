// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>
#include <weft/core/result.hpp>
#include <weft/evaluation/alignment.hpp>
#include <weft/evaluation/frame_metrics.hpp>

namespace weft::evaluation {

class RunReader;
struct FrameLine;
struct FrameRecords;

/// 3D error of a run: statistics over the frames' mean errors, each frame counting the same.
struct ErrorSummary {
  std::int64_t frames = 0;              ///< [] with an error
  double mean_mm = kUnknown;            ///< [] mm
  double standard_error_mm = kUnknown;  ///< [] mm, of the mean; from 2 frames on
  double median_mm = kUnknown;          ///< [] mm
  double p95_mm = kUnknown;             ///< [] mm
  double worst_mm = kUnknown;           ///< [] mm, largest mean error of a frame
  std::string worst_frame;              ///< which frame that is
  double worst_point_mm = kUnknown;     ///< [] mm, largest error of a point
  double of_depth_percent = kUnknown;   ///< [] mean over the frames
};

/// Frames with one kind of truth, or those among them that are reported apart for one reason.
/// frames = solved + held + missing + invalid.
struct GroupMetrics {
  std::string kind;
  std::string apart;        ///< the reason; empty for the frames that count
  std::int64_t frames = 0;  ///< [] with truth
  std::int64_t solved = 0;
  std::int64_t held = 0;
  std::int64_t missing = 0;  ///< [] failures: truth, but no shape
  std::int64_t invalid = 0;  ///< [] failures: NaN or infinity
  std::int64_t off = 0;      ///< [] failures: solved or held, but off
  /// [] solved or held and truth with points, but no error: none on the mesh, no alignment
  std::int64_t unmeasured = 0;
  std::int64_t points = 0;
  std::int64_t extrapolated = 0;
  std::int64_t unlocated = 0;
  ErrorSummary solved_error;      ///< of solved frames
  ErrorSummary held_error;        ///< of held frames, never mixed with the former
  double strain_mean = kUnknown;  ///< [] mean over solved frames
  double strain_p95 = kUnknown;   ///< [] mean over solved frames of the 95th percentile

  std::int64_t failures() const { return missing + invalid + off; }
};

/// MotionMetrics over all triples of solved frames that follow each other without a cut.
struct Jitter {
  std::int64_t triples = 0, truth_triples = 0;
  std::int64_t cuts = 0;            ///< [] frames before which the truth jumps
  double mean_mm = kUnknown;        ///< [] mm
  double median_mm = kUnknown;      ///< [] mm, hardly moved by cuts that no truth tells
  double truth_mean_mm = kUnknown;  ///< [] mm
};

/// Means of ImageMetrics over solved frames.
struct ImageSummary {
  double match_tolerance_px = kUnknown;  ///< [] px
  std::int64_t reprojection_frames = 0, overlay_frames = 0;
  std::int64_t reprojection_matches = 0, overlay_vertices = 0;
  std::int64_t behind_camera_frames = 0;  ///< [] without these figures
  double reprojection_px = kUnknown;      ///< [] px
  double overlay_px = kUnknown;           ///< [] px
  double truth_map_px = kUnknown;         ///< [] px, median over frames
};

/// DepthMetrics over solved frames with a depth image.
struct DepthSummary {
  std::int64_t frames = 0;  ///< [] with a median
  std::int64_t frames_without_median = 0;
  std::int64_t matches = 0, without_depth = 0;
  double mean_mm = kUnknown;    ///< [] mm, mean over frames of their medians
  double median_mm = kUnknown;  ///< [] mm, median over frames of their medians
  double worst_mm = kUnknown;   ///< [] mm, largest median of a frame
};

/// All frames, with truth or without. frames is the sum of the six that follow.
struct FrameCounts {
  std::int64_t frames = 0;
  std::int64_t estimated = 0, weak = 0, predicted = 0, lost = 0, none = 0, invalid = 0;
  std::int64_t failed = 0;  ///< [] with an error somewhere; they are counted above too

  std::int64_t solved() const { return estimated + weak; }
};

struct RunMetrics {
  std::string run;  ///< name of the folder
  Alignment alignment = Alignment::none;
  bool has_solver = true;    ///< without one there are no shapes, no groups and no failures
  bool interrupted = false;  ///< the run was killed while it wrote a frame's line
  std::vector<std::string> truth_users;  ///< components that may have read the truth
  FrameCounts counts;
  double strain_mean = kUnknown;       ///< [] mean over all solved frames
  double strain_p95 = kUnknown;        ///< [] mean over them of the 95th percentile
  std::vector<GroupMetrics> groups;    ///< by kind, then reason; kinds without a reason first
  GroupMetrics all;                    ///< every frame with truth that is not apart
  ImageSummary image;                  ///< frames apart are left out
  DepthSummary depth;                  ///< frames apart are left out
  VisibilityMetrics visibility;        ///< frames apart are left out
  CertaintyMetrics certainty;          ///< frames apart are left out
  std::vector<FilterMetrics> filters;  ///< by stage; frames apart are left out
  std::vector<WarpMetrics> warps;      ///< by stage; frames apart are left out
  Jitter jitter;
  std::vector<FrameMetrics> frames;  ///< in order
};

struct EvaluationOptions {
  Alignment alignment = Alignment::none;
  double match_tolerance_px = 2.0;  ///< [] px, a match this near its true place is correct
};

/// Evaluates a run folder against the ground truth in it; changes nothing. A run without truth has
/// counts, strains and jitter only. Fails where the folder is no run folder or files in it are
/// damaged; the Error names the first and counts them.
Result<RunMetrics> evaluate_run(const std::string& folder, const EvaluationOptions& options = {});

/// The same, frame by frame, of a run that need not be written.
class RunEvaluator {
 public:
  /// `scene` has the template and the camera, and must outlive this. Fails on a template that
  /// cannot be measured.
  static Result<RunEvaluator> create(const RunReader& scene, const EvaluationOptions& options);

  RunEvaluator(RunEvaluator&& other) noexcept;
  RunEvaluator& operator=(RunEvaluator&& other) noexcept;
  ~RunEvaluator();

  /// Frames in their order.
  Result<void> add(const FrameLine& line, const FrameRecords& records);

  const std::vector<FrameMetrics>& frames() const;

  /// What the frames came to; ends the evaluation. Without a solver no shape is missing. `run` and
  /// what a run folder says of itself are for the caller to fill in.
  RunMetrics finish(bool has_solver);

 private:
  struct State;
  explicit RunEvaluator(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace weft::evaluation
