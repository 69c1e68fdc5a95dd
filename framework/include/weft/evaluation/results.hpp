// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>
#include <weft/core/result.hpp>
#include <weft/evaluation/damage.hpp>
#include <weft/evaluation/frame_metrics.hpp>

/// The results folder of an ablation, read for tables and figures; see docs/results.md.
namespace weft::evaluation {

/// An axis of the plan and the names of its values, in the plan's order.
struct PlanAxis {
  std::string name;
  std::vector<std::string> values;
  std::string swept;            ///< the number that it sweeps; empty: it sweeps none
  std::vector<double> numbers;  ///< with `swept`, one a value; NaN: the value sets no such number
  std::vector<std::string>
      families;  ///< one a value, where `swept` is several numbers; empty: none
};

/// `missing` is a cell of the plan that has not been run yet.
enum class CellOutcome { done, failed, missing };

const char* to_string(CellOutcome outcome);

/// A frame whose truth counts. Without a shape of its own it has no error.
struct FrameError {
  std::uint64_t frame = 0;    ///< [] index from 0
  double mean_mm = kUnknown;  ///< [] mm, mean over the frame's points; NaN unless solved
};

/// Rates of a filter stage, each averaged over the frames in which it is defined.
struct FilterRates {
  std::string stage;
  double tpr_percent = kUnknown;        ///< [] mismatches rejected, of all mismatches
  double fpr_percent = kUnknown;        ///< [] correct matches rejected, of all correct ones
  double kept_percent = kUnknown;       ///< [] kept, of those that entered
  double precision_percent = kUnknown;  ///< [] correct, of those kept
  std::int64_t entered = 0, mismatches = 0, correct = 0;  ///< [] over all frames
  /// Scores in equal parts of [0, 1]: how many mismatches and how many correct matches.
  std::vector<std::int64_t> scores_of_mismatches = {}, scores_of_correct = {};
};

/// Time of a stage for a frame, of a pass with --timing.
struct StageTime {
  std::string stage;
  double mean_ms = kUnknown;            ///< [] ms
  double median_ms = kUnknown;          ///< [] ms
  double mean_processor_ms = kUnknown;  ///< [] ms; NaN in results of older programs
};

/// What solved frames said of their own error, and what came true; see CertaintyMetrics.
struct CertaintyCounts {
  std::int64_t frames = 0, right = 0, silently_wrong = 0;
  double squares = 0.0;                    ///< [] sum of (confidence - right)^2
  std::vector<ConfidenceBin> bins = {};    ///< equal parts of [0, 1]; empty without frames
  std::int64_t vertices = 0;               ///< [] with a standard deviation
  std::array<double, 3> within_percent{};  ///< [] of them within 1, 2, 3 standard deviations

  /// Adds up what two runs counted.
  void add(const CertaintyCounts& other);
  /// Mean over the frames that told one.
  double confidence() const;
  double brier() const { return frames > 0 ? squares / static_cast<double>(frames) : kUnknown; }
};

/// What the results say of one key: the cells that have it share it.
struct CellRecord {
  CellOutcome outcome = CellOutcome::missing;
  std::string reason;                           ///< of a failure
  std::int64_t frames = 0, solved = 0;          ///< [] of all frames
  std::int64_t truth_frames = 0, failures = 0;  ///< [] with truth that counts; of them failures
  double mean_mm = kUnknown;                    ///< [] mm, mean over solved frames with truth
  double worst_mm = kUnknown;                   ///< [] mm, largest mean error of a frame
  std::string worst_frame;
  std::vector<std::string> truth_users;   ///< components that may have read the truth
  std::vector<FrameError> errors;         ///< in the order of the frames
  std::vector<FilterRates> filters;       ///< in the order of the stages
  CertaintyCounts certainty;              ///< empty where the run says nothing of it
  std::vector<StageTime> times;           ///< empty where no uncached time was taken
  std::map<std::string, double> figures;  ///< by metric: those that the plan names

  /// A figure that the plan names, NaN where the run has none.
  double figure(const std::string& metric) const;
};

/// A cell of the plan.
struct PlanCell {
  std::int64_t index = 0;
  std::vector<std::string> values;  ///< one for each axis
  std::string sequence;
  std::uint64_t seed = 0;
  std::string key;
};

/// What the plan compares: the values of an axis, in a metric, the rest paired.
struct PlanComparison {
  std::string axis, metric;
  std::string reference;  ///< a value of the axis; empty: each with each
};

/// A figure that the plan expects of the mean over the cells that `where` selects.
struct PlanExpectation {
  std::vector<std::pair<std::string, std::string>> where;  ///< axis, data, sequence or seed
  std::string metric;
  double at_least = kUnknown, at_most = kUnknown;  ///< NaN: no bound
};

/// Frames of a sequence, as the cells say that got through it.
struct SequenceSize {
  std::int64_t frames = 0, truth_frames = 0;
};

struct Results {
  std::string folder, name;     ///< name: of the plan
  std::string command;          ///< that wrote the folder
  std::string version;          ///< of weft
  std::string data_use;         ///< "tuning", "reporting" or empty
  bool accept_rebuilt = false;  ///< results of differently built components may stand side by side
  std::string alignment = "none";        ///< that every error was measured with
  double match_tolerance_px = kUnknown;  ///< [] px, up to which a match is correct
  std::vector<PlanAxis> axes;
  std::vector<std::string> sequences;
  std::vector<std::uint64_t> seeds;
  std::map<std::string, std::string> data_of;  ///< name of the data of each sequence
  std::vector<std::string> show;               ///< metrics that the plan wants in its table
  std::vector<PlanComparison> comparisons;
  std::vector<PlanExpectation> expectations;
  std::vector<PlanCell> cells;
  std::map<std::string, CellRecord> records;  ///< by key
  std::map<std::string, SequenceSize> sizes;  ///< by sequence
  std::set<std::string> processors;           ///< that computed them
  std::vector<Damage> damaged;                ///< results that are left out for it
  std::size_t unchecked = 0;                  ///< lines without a check, of older programs

  /// What is known of a cell; outcome `missing` where nothing is.
  const CellRecord& record(const PlanCell& cell) const;
  /// Frames that the cell was to solve: those of its sequence, where it failed before the first.
  SequenceSize size(const PlanCell& cell) const;
};

/// Reads a results folder; what was cut off or damaged is left out. Fails with not_found where the
/// folder is none, with incompatible at another schema, with invalid_data at a damaged plan.
Result<Results> read_results(const std::string& folder);

}  // namespace weft::evaluation
