// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "lab/report/tables/scene_effects.hpp"
#include "lab/report/tables/statistics.hpp"
#include "lab/results/expectations.hpp"

/// The tables of a report. Sequences count the same: a figure of a combination is the mean over its
/// sequences of the mean over the seeds of a sequence.
namespace weft::lab {

/// Rates of a filter stage over the cells of a combination: means over sequences, sums of counts.
struct FilterSummary {
  FilterRates rates;
  std::int64_t sequences = 0;  ///< [] with rates
};

/// One value of each axis: what the tables compare.
struct Combination {
  std::string name;                 ///< its values on the axes that have several
  std::vector<std::string> values;  ///< one for each axis
  std::vector<std::size_t> cells;   ///< indices into PlanRecord::cells
  double mean_mm = kUnknown;        ///< [] mm, over sequences
  Interval interval_mm;             ///< [] mm, 95 % of the mean, by sequence
  double worst_mm = kUnknown;       ///< [] mm, largest mean error of a frame
  std::string worst_place = {};     ///< sequence, seed and frame of it
  std::int64_t sequences = 0;       ///< [] with an error, the n of the interval
  /// [] over its cells; a cell that failed before its first frame failed at every one
  std::int64_t frames = 0, solved = 0;
  std::int64_t truth_frames = 0, failures = 0;     ///< [] with truth that counts; of them failures
  std::int64_t frames_in_error = 0;                ///< [] of the frames of its cells
  std::string first_error = {};                    ///< the first of them, with its cell
  std::int64_t done = 0, failed = 0, missing = 0;  ///< [] cells
  /// Its solvers, warps and filters that state it: "filters/tran: reconstruction".
  std::vector<std::string> implements = {};
  bool uses_truth = false;                  ///< a component may have read the truth: no measurement
  std::vector<FilterSummary> filters = {};  ///< in the order of the stages
  CertaintyCounts certainty = {};           ///< over its cells, all frames alike
  std::vector<StageTime> times = {};        ///< empty without a pass with --timing
  double processor_ms = kUnknown;           ///< [] a frame, of all stages; NaN without such a pass
  std::vector<double> shown = {};  ///< one for each metric of PlanRecord::show, over sequences
  bool selectable = false;         ///< the page has its curves
  bool detailed = false;           ///< the page lists its cells

  /// The rates of a stage, or nullptr.
  const FilterRates* filter(const std::string& stage) const;
};

/// Result of a comparison of the plan.
struct ComparisonResult {
  PlanComparison plan;
  std::string unit;  ///< unit of the metric
  ComparisonTable table;
  std::vector<SeparateComparison> separate;      ///< by other axes
  std::vector<std::vector<SceneEffect>> scenes;  ///< one list for each pair of `table`
};

struct ReportTables {
  std::vector<Combination> combinations;         ///< in the plan's order
  std::vector<std::string> filter_stages;        ///< [.] names
  std::vector<ComparisonResult> comparisons;     ///< one for each of the plan
  std::vector<ExpectationOutcome> expectations;  ///< one for each of the plan
  bool has_error = false;                        ///< some combination has a 3D error
  bool has_times = false;                        ///< some combination has times
};

/// The combinations with the smallest mean errors, at most `most`, in the plan's order.
std::vector<std::size_t> best_combinations(const std::vector<Combination>& combinations,
                                           std::size_t most);

/// The combinations of a plan with nothing but names and cells.
std::vector<Combination> combinations_of(const Results& results);

/// Fails where a comparison of the plan cannot be made.
Result<ReportTables> make_tables(const Results& results);

}  // namespace weft::lab
