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

/// A pipeline with its settings.
struct Entry {
  std::string name;  ///< in tables and ratios
  std::string file;
  std::vector<std::string> settings;  ///< [.] "PATH=VALUE"
};

/// The stems of the files; what a name was given to before gets "#2", "#3" behind it.
void name_entries(std::vector<Entry>& entries);

/// One row of the table: the source, a stage, a sink, the host, or the whole frame.
struct Row {
  std::string part, component;
  std::map<std::string, std::int64_t> statuses;  ///< frames; of stages and sinks alone
  Spread ms, processor_ms;
  std::optional<Spread> blocks, bytes;  ///< allocations; absent where not counted
  std::optional<Moved> moved;           ///< [bytes] of records, mean of the frames; of stages alone
  double floor_ms = kUnknown;           ///< [] for moving those once, at the speed of memory
};

struct PipelineReport {
  Entry entry;
  std::map<std::string, std::int64_t> states;  ///< states of the shapes, warm-up included
  std::vector<Row> rows;                       ///< [.] rows of the table
  std::vector<Part> parts;                     ///< the parts that the rows measure, except the
                                               ///< source
  std::optional<Counts> counts;
  std::string why_no_counts;                ///< empty when there are
  std::optional<OverlapFigures> overlap{};  ///< present on request
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
  std::vector<PipelineReport> pipelines;  ///< [.] in the given order
  std::vector<RatioReport> ratios;        ///< [.] ratios of two pipelines
};

/// The median of a row's CPU time as a multiple of its floor, which is that of one thread too;
/// wall-clock time would include the work of others. Unknown where there is no floor.
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
