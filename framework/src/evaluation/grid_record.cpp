// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <weft/core/version.hpp>
#include <weft/evaluation/metrics.hpp>

#include "axis_sweep.hpp"
#include "cell_line.hpp"

namespace weft::evaluation {
namespace {

using nlohmann::ordered_json;

/// Text of any bytes as JSON: what is no UTF-8 is replaced.
std::string plan_dump(const ordered_json& value, int indent) {
  return value.dump(indent, ' ', false, ordered_json::error_handler_t::replace) + "\n";
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

std::string manifest_text(const Grid& grid, bool accept_rebuilt) {
  return plan_dump({{"schema", kFolderSchema},
                    {"weft", kVersion},
                    {"plan", grid.plan().name},
                    {"metrics", measurement_json(grid.plan().measurement)},
                    {"accept_rebuilt", accept_rebuilt}},
                   2);
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
  return plan_dump({{"name", plan.name},
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
                   1);
}

}  // namespace weft::evaluation
