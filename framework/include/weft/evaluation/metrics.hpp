// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>
#include <weft/core/result.hpp>
#include <weft/data/shape.hpp>
#include <weft/evaluation/alignment.hpp>
#include <weft/evaluation/match_metrics.hpp>

namespace weft::evaluation {

inline constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// A frame is off when its mean error exceeds this share of the template's diagonal.
inline constexpr double kOffShare = 0.1;

/// What a frame came to: `solved` is estimated or weak, `held` predicted or lost (an old shape),
/// `missing` without a shape, `invalid` with a shape that is not finite, whatever its state.
enum class Outcome { solved, held, missing, invalid };

const char* to_string(Outcome outcome);

/// 3D error of one shape over the truth points that lie on the mesh. Percentiles are interpolated
/// linearly at the rank p/100 (n - 1).
struct PointSummary {
  double mean_mm = kUnknown;     ///< [] mm
  double median_mm = kUnknown;   ///< [] mm
  double p95_mm = kUnknown;      ///< [] mm
  double worst_mm = kUnknown;    ///< [] mm
  std::int64_t worst_point = 0;  ///< [] index into the truth
};

/// Errors in the image, of a solved frame with truth and matches. Never aligned.
struct ImageMetrics {
  double reprojection_px = kUnknown;  ///< [] px, mean over the correct matches, see docs/metrics.md
  double overlay_px = kUnknown;       ///< [] px, mean over the vertices whose true place is known
  double truth_map_px = kUnknown;     ///< [] px, how well the truth foretells itself
};

struct FrameMetrics {
  std::uint64_t frame = 0;  ///< [] index from 0
  std::string stem;
  ShapeState state = ShapeState::none;
  Outcome outcome = Outcome::missing;
  bool failed = false;  ///< a stage, the source or a sink had an error
  bool has_truth = false;
  std::string kind;               ///< of the truth
  std::string apart;              ///< why the frame is reported apart, or empty
  std::int64_t points = 0;        ///< [] of the truth
  std::int64_t extrapolated = 0;  ///< [] of them beside the mesh, but close
  std::int64_t unlocated = 0;     ///< [] of them without a place on the mesh: not in the error
  std::optional<PointSummary> error;
  std::string no_error_because;   ///< there is truth, but no error
  double strain_mean = kUnknown;  ///< [] mean |l / l0 - 1| over the edges
  double strain_p95 = kUnknown;   ///< [] 95th percentile of it
  ImageMetrics image;
  std::vector<std::pair<std::string, FilterCounts>> filters;  ///< by stage

  /// The stem, or the index where there is no stem.
  std::string label() const { return stem.empty() ? std::to_string(frame) : stem; }
};

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
  std::int64_t unmeasured =
      0;                 ///< [] solved or held, but no error: no point on the mesh, no alignment
  std::int64_t off = 0;  ///< [] solved, but off
  std::int64_t points = 0;
  std::int64_t extrapolated = 0;
  std::int64_t unlocated = 0;
  ErrorSummary solved_error;      ///< of solved frames
  ErrorSummary held_error;        ///< of held frames, never mixed with the former
  double strain_mean = kUnknown;  ///< [] mean over solved frames

  std::int64_t failures() const { return missing + invalid; }
};

/// Mean |X_t - 2 X_(t-1) + X_(t-2)| over vertices and over runs of three solved frames; of the
/// truth over its points where the three frames have truth at the same points.
struct Jitter {
  std::int64_t triples = 0, truth_triples = 0;
  double mean_mm = kUnknown;        ///< [] mm
  double truth_mean_mm = kUnknown;  ///< [] mm
};

/// Means of ImageMetrics over frames.
struct ImageSummary {
  double match_tolerance_px = kUnknown;  ///< [] px
  std::int64_t reprojection_frames = 0, overlay_frames = 0;
  double reprojection_px = kUnknown;  ///< [] px
  double overlay_px = kUnknown;       ///< [] px
  double truth_map_px = kUnknown;     ///< [] px, median over frames
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
  bool interrupted = false;              ///< the run was killed while it wrote a frame's line
  std::vector<std::string> truth_users;  ///< components that may have read the truth
  FrameCounts counts;
  double strain_mean = kUnknown;       ///< [] mean over all solved frames
  std::vector<GroupMetrics> groups;    ///< by kind, then reason; kinds without a reason first
  GroupMetrics all;                    ///< every frame with truth that is not apart
  ImageSummary image;                  ///< frames apart are left out
  std::vector<FilterMetrics> filters;  ///< by stage; frames apart are left out
  Jitter jitter;
  std::vector<FrameMetrics> frames;  ///< in order
};

struct EvaluationOptions {
  Alignment alignment = Alignment::none;
  double match_tolerance_px = 2.0;  ///< [] px, a match this near its true place is correct
};

/// Evaluates a run folder against the ground truth in it; changes nothing. A run without truth has
/// counts and strains only. Fails where the folder is no run folder or a file in it is damaged.
Result<RunMetrics> evaluate_run(const std::string& folder, const EvaluationOptions& options = {});

}  // namespace weft::evaluation
