// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>
#include <weft/core/result.hpp>

#include "lab/metrics/frame_metrics.hpp"
#include "lab/results/damage.hpp"

/// Contents of the lines of a results folder about its cells; see docs/results.md.
namespace weft::lab {

/// `missing` is a cell of the plan that has not been run yet.
enum class CellOutcome { done, failed, missing };

const char* to_string(CellOutcome outcome);

/// A frame whose truth counts. It has no error if it has no new shape.
struct FrameError {
  std::uint64_t frame = 0;    ///< [] index from 0
  double mean_mm = kUnknown;  ///< [] mm, mean over the frame's points; NaN unless solved
};

/// Rates of a filter stage, each averaged over the frames in which it is defined.
struct FilterRates {
  std::string stage;
  double tpr_percent = kUnknown;        ///< [] mismatches rejected, of all mismatches
  double fpr_percent = kUnknown;        ///< [] share of the inliers that were rejected
  double kept_percent = kUnknown;       ///< [] kept, of those that entered
  double precision_percent = kUnknown;  ///< [] correct, of those kept
  std::int64_t entered = 0, mismatches = 0, correct = 0;  ///< [] over all frames
  /// Histograms of the scores in equal parts of [0, 1]: the numbers of mismatches and of inliers.
  std::vector<std::int64_t> scores_of_mismatches = {}, scores_of_correct = {};
};

/// Time of a stage for a frame, of a pass with --timing.
struct StageTime {
  std::string stage;
  double mean_ms = kUnknown;            ///< [] ms
  double median_ms = kUnknown;          ///< [] ms
  double mean_processor_ms = kUnknown;  ///< [] ms; NaN in results of older programs
};

/// The errors that solved frames predicted and the true ones; see CertaintyMetrics.
struct CertaintyCounts {
  std::int64_t frames = 0, right = 0, silently_wrong = 0;  ///< [] numbers of frames
  double squares = 0.0;                                    ///< [] sum of (confidence - right)^2
  std::vector<ConfidenceBin> bins = {};    ///< equal parts of [0, 1]; empty without frames
  std::int64_t vertices = 0;               ///< [] with a standard deviation
  std::array<double, 3> within_percent{};  ///< [] of them within 1, 2, 3 standard deviations

  /// Adds up what two runs counted.
  void add(const CertaintyCounts& other);
  /// Mean over the frames that have a confidence.
  double confidence() const;
  double brier() const { return frames > 0 ? squares / static_cast<double>(frames) : kUnknown; }
};

/// Where a line stands.
struct LinePlace {
  std::string file;          ///< name, without folders
  int number = 0;            ///< from 1
  std::uint64_t offset = 0;  ///< [bytes]
};

/// The results for one key, which all cells with the key share. A failed cell has no figures that
/// enter a mean, and counts as failed in each of its frames.
struct CellRecord {
  CellOutcome outcome = CellOutcome::missing;
  std::string reason;  ///< reason of a failure
  std::string key, rebuilt_key;
  LinePlace place;
  bool timed = false;                 ///< its line has times
  std::vector<std::string> executed;  ///< stages that the cell ran itself
  std::vector<CellFile> files;        ///< files of its folder; none in lines of older programs
  std::string processor;              ///< that computed it

  std::int64_t frames = 0, solved = 0;          ///< [] of all frames
  std::int64_t frames_in_error = 0;             ///< [] in which a stage, the source or a sink erred
  std::string first_error;                      ///< "frame 3, filters: ..."; empty in older lines
  std::int64_t truth_frames = 0, failures = 0;  ///< [] with truth that counts; of them failures
  double mean_mm = kUnknown;                    ///< [] mm, mean over solved frames with truth
  double worst_mm = kUnknown;                   ///< [] mm, largest mean error of a frame
  std::string worst_frame;
  std::vector<std::string> truth_users;   ///< components that may have read the truth
  std::vector<std::string> implements;    ///< "filters/tran: reconstruction"; empty in older lines
  std::vector<FrameError> errors;         ///< in the order of the frames, on request
  std::vector<FilterRates> filters;       ///< in the order of the stages
  CertaintyCounts certainty;              ///< empty if the run has no confidences
  std::vector<StageTime> times;           ///< empty where no uncached time was taken
  double processor_ms = kUnknown;         ///< [] ms a frame of all stages, the source not counted
  std::map<std::string, double> figures;  ///< by metric: the requested ones
  double seconds = kUnknown;  ///< [s] its process took for it; NaN in lines of older programs

  bool done() const { return outcome == CellOutcome::done; }
  bool failed() const { return outcome == CellOutcome::failed; }
  /// NaN where the run has no such figure.
  double figure(const std::string& metric) const;
};

/// All that a folder has.
struct CellRecords {
  std::map<std::string, CellRecord> cells;  ///< finished ones, by key
  std::vector<Damage> damaged;              ///< [.] results that cannot be trusted
  std::size_t unchecked = 0;                ///< lines without a check, of older programs
};

/// The parts of cells to read beyond the ones that are always read.
struct CellParts {
  std::set<std::string> metrics = {};
  bool frames = false;   ///< the error of each frame
  bool content = false;  ///< compare the files of cells with the hashes in their lines
  bool figures = true;   ///< without: what came of a cell alone, no number of its metrics
};

/// All finished cells of a results folder. A line that was cut off is none. Fails where a file
/// cannot be read or has a line of another schema.
Result<CellRecords> read_cell_records(const std::string& folder, const CellParts& parts);

}  // namespace weft::lab
