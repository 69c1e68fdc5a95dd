// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "lab/bench/counts.hpp"
#include "lab/bench/figures.hpp"
#include "lab/bench/machine_speed.hpp"
#include "lab/bench/overlap.hpp"
#include "lab/bench/pipeline_subject.hpp"

namespace weft::bench {

/// A pipeline as it was asked for.
struct Entry {
  std::string name;  ///< in tables and ratios
  std::string file;
  std::vector<std::string> settings;
};

/// The stems of the files; what a name was given to before gets "#2", "#3" behind it.
void name_entries(std::vector<Entry>& entries);

/// One row of the table: the source, a stage, a sink, the host, or the whole frame.
struct Row {
  std::string part, component;
  std::map<std::string, std::int64_t> statuses;  ///< frames; of stages and sinks alone
  Spread ms, processor_ms;
  std::optional<Spread> blocks, bytes;  ///< asked of the allocator; absent where not counted
  std::optional<Moved> moved;           ///< [bytes] of records, mean of the frames; of stages alone
  double floor_ms = kUnknown;           ///< [] for moving those once, at the speed of memory
};

struct PipelineReport {
  Entry entry;
  std::map<std::string, std::int64_t> states;  ///< of the shapes, warm-up included
  std::vector<Row> rows;
  std::vector<Part> parts;  ///< what the rows are of, but for the source
  std::optional<Counts> counts;
  std::string why_no_counts;                ///< empty when there are
  std::optional<OverlapFigures> overlap{};  ///< where it was asked for
};

/// How one pipeline's part compares with another one's.
struct RatioReport {
  std::string of, over, part;
  Ratio wall, processor;
};

struct Report {
  Settings settings;
  std::string command, processor;
  MachineSpeed speed;
  std::string baseline;  ///< whose times are 1; empty when there is one pipeline alone
  std::vector<PipelineReport> pipelines;
  std::vector<RatioReport> ratios;
};

/// The median of a row's processor time as a multiple of its floor, which is of one thread too;
/// time on the wall would have the work of others in it. Unknown where there is no floor.
double times_floor(const Row& row);

/// The rows of a pipeline. `counts` fails where they could not be had.
PipelineReport report_of(const Entry& entry, const PipelineSubject& subject,
                         const std::vector<Sample>& samples, const Result<Counts>& counts,
                         const MachineSpeed& speed);

/// Adds what was measured of frames that overlap.
void add_overlap(const PipelineSubject& subject, const std::vector<Overlapped>& repetitions,
                 std::int64_t warmup, PipelineReport& report);

/// The frame and all parts that both have by name; of the first pipeline over each other one, and
/// of each over the baseline.
std::vector<RatioReport> ratios_of(const std::vector<PipelineReport>& pipelines,
                                   const std::string& baseline);

/// Schema weft-bench/1, see docs/benchmarks.md.
std::string json_of(const Report& report);

/// For people.
std::string table_of(const Report& report);

}  // namespace weft::bench
