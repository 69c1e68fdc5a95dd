// SPDX-License-Identifier: Apache-2.0
#include "cell_line.hpp"

#include <sys/utsname.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <weft/core/statistics.hpp>
#include <weft/core/version.hpp>
#include <weft/evaluation/metrics_report.hpp>
#include <weft/host/processor.hpp>

#include "axis_sweep.hpp"

namespace weft::evaluation {
namespace {

using nlohmann::json;
using nlohmann::ordered_json;

/// Text of any bytes as JSON: what is no UTF-8 is replaced.
std::string dump(const ordered_json& value, int indent = -1) {
  return value.dump(indent, ' ', false, ordered_json::error_handler_t::replace);
}

ordered_json metrics_json(const CellResult& result, bool with_frames) {
  if (!result.metrics) return nullptr;
  ordered_json metrics = ordered_json::parse(to_json(*result.metrics));
  if (!with_frames) metrics["frames"] = ordered_json::array();
  return metrics;
}

ordered_json timing_json(const CellResult& result, bool timed) {
  if (!timed) return {{"cached", true}};
  ordered_json stages = ordered_json::array();
  for (const StageTiming& timing : result.timings) {
    if (timing.ms.empty()) continue;
    stages.push_back({{"stage", timing.stage},
                      {"frames", timing.ms.size()},
                      {"mean_ms", mean(timing.ms)},
                      {"p50_ms", percentile(timing.ms, 50.0)},
                      {"p95_ms", percentile(timing.ms, 95.0)}});
  }
  const std::int64_t frames = result.metrics ? result.metrics->counts.frames : 0;
  return {{"frames", frames}, {"stages", std::move(stages)}};
}

ordered_json measurement_json(const Measurement& measurement) {
  return {{"alignment", to_string(measurement.options.alignment)},
          {"match_tolerance_px", measurement.options.match_tolerance_px},
          {"frames", measurement.frames}};
}

/// All values of the cell by name.
ordered_json selection_json(const Selection& where) {
  ordered_json values = ordered_json::object();
  for (const auto& [name, value] : where) values[name] = value;
  return values;
}

ordered_json cells_json(const Grid& grid) {
  ordered_json cells = ordered_json::array();
  for (const Cell& cell : grid.cells()) {
    ordered_json axes = ordered_json::object();
    for (const Axis& axis : grid.plan().axes) axes[axis.name] = grid.value_of(cell, axis.name);
    cells.push_back({{"cell", cells.size()},
                     {"axes", std::move(axes)},
                     {"sequence", grid.value_of(cell, "sequence")},
                     {"seed", cell.seed},
                     {"key", cell.identity.key},
                     {"group", cell.identity.group}});
  }
  return cells;
}

ordered_json expectation_json(const Expectation& expectation) {
  ordered_json entry{{"where", selection_json(expectation.where)}, {"metric", expectation.metric}};
  if (expectation.at_most) entry["at_most"] = *expectation.at_most;
  if (expectation.at_least) entry["at_least"] = *expectation.at_least;
  return entry;
}

ordered_json comparison_json(const PlannedComparison& comparison) {
  ordered_json entry{
      {"axis", comparison.axis}, {"reference", nullptr}, {"metric", comparison.metric}};
  if (comparison.reference) entry["reference"] = *comparison.reference;
  return entry;
}

ordered_json names_json(const std::vector<NamedPatch>& patches) {
  ordered_json names = ordered_json::array();
  for (const NamedPatch& patch : patches) names.push_back(patch.name);
  return names;
}

ordered_json axis_json(const Axis& axis) {
  ordered_json object{{"name", axis.name}, {"values", names_json(axis.values)}};
  if (const auto sweep = sweep_of(axis)) {
    object["swept"] = sweep->name;
    object["numbers"] = sweep->numbers;
    if (!sweep->families.empty()) object["families"] = sweep->families;
  }
  return object;
}

}  // namespace

std::string cell_line(const Cell& cell, const CellResult& result, bool timed,
                      const Measurement& measurement) {
  ordered_json stages = ordered_json::array();
  for (std::size_t i = 0; i < cell.stages.size(); ++i) {
    stages.push_back({{"stage", cell.stages[i]}, {"key", cell.identity.stages[i]}});
  }
  utsname system{};
  uname(&system);
  return dump({{"schema", kLineSchema},
               {"key", cell.identity.key},
               {"rebuilt_key", cell.identity.rebuilt_key},
               {"outcome", result.failure.empty() ? "done" : "failed"},
               {"reason", result.failure},
               {"metrics", metrics_json(result, measurement.frames)},
               {"stages", std::move(stages)},
               {"timing", timing_json(result, timed)},
               {"machine",
                {{"processor", host::processor_name()},
                 {"system", system.release},
                 {"executed", result.executed}}}});
}

Result<StoredCell> parse_cell_line(const std::string& line) {
  const auto leave_frames_out = [](int depth, json::parse_event_t event, json& parsed) {
    return !(depth == 2 && event == json::parse_event_t::key && parsed == "frames");
  };
  const json object = json::parse(line, leave_frames_out, false);
  const Error damaged{Errc::invalid_data, "is no line of a cell", {}};
  if (!object.is_object()) return damaged;
  const std::string schema = object.value("schema", std::string());
  if (schema != kLineSchema) {
    return Error{Errc::invalid_data,
                 "has the schema '" + schema + "', this program reads '" + kLineSchema + "'",
                 {}};
  }
  try {
    StoredCell cell;
    cell.key = object.at("key");
    cell.rebuilt_key = object.at("rebuilt_key");
    cell.failed = object.at("outcome") != "done";
    cell.reason = object.at("reason");
    cell.timed = !object.at("timing").value("cached", false);
    cell.metrics = object.at("metrics").dump();
    cell.executed = object.at("machine").at("executed").get<std::vector<std::string>>();
    return cell;
  } catch (const json::exception&) {
    return damaged;
  }
}

std::string manifest_text(const Grid& grid, bool accept_rebuilt) {
  return dump({{"schema", kFolderSchema},
               {"weft", kVersion},
               {"plan", grid.plan().name},
               {"metrics", measurement_json(grid.plan().measurement)},
               {"accept_rebuilt", accept_rebuilt}},
              2) +
         "\n";
}

std::string plan_text(const Grid& grid, const std::string& command) {
  const Plan& plan = grid.plan();
  ordered_json axes = ordered_json::array(), data = ordered_json::array();
  ordered_json sequences = ordered_json::array(), show = ordered_json::array();
  for (const Axis& axis : plan.axes) {
    axes.push_back(axis_json(axis));
  }
  for (const PlannedData& each : plan.data) {
    data.push_back({{"name", each.name}, {"sequences", names_json(each.sequences)}});
    for (const NamedPatch& sequence : each.sequences) sequences.push_back(sequence.name);
  }
  std::vector<std::uint64_t> seeds = plan.seeds;
  for (const Cell& cell : grid.cells()) {
    if (std::find(seeds.begin(), seeds.end(), cell.seed) == seeds.end()) seeds.push_back(cell.seed);
  }
  for (const auto& [metric, at] : plan.show) show.push_back(metric);
  ordered_json comparisons = ordered_json::array(), expect = ordered_json::array();
  for (const PlannedComparison& each : plan.comparisons)
    comparisons.push_back(comparison_json(each));
  for (const Expectation& each : plan.expect) expect.push_back(expectation_json(each));
  return dump({{"name", plan.name},
               {"file", plan.source.name},
               {"command", command},
               {"data_use", plan.reporting ? "reporting" : "tuning"},
               {"axes", std::move(axes)},
               {"sequences", std::move(sequences)},
               {"data", std::move(data)},
               {"seeds", std::move(seeds)},
               {"show", std::move(show)},
               {"cells", cells_json(grid)},
               {"comparisons", std::move(comparisons)},
               {"expect", std::move(expect)}},
              1) +
         "\n";
}

}  // namespace weft::evaluation
