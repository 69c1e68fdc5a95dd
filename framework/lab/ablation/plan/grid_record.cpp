// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "lab/ablation/plan/axis_sweep.hpp"
#include "lab/ablation/plan/grid.hpp"

namespace weft::lab {
namespace {

std::vector<std::string> names_of(const std::vector<NamedPatch>& patches) {
  std::vector<std::string> names;
  for (const NamedPatch& patch : patches) names.push_back(patch.name);
  return names;
}

PlanAxis axis_record(const Axis& axis) {
  PlanAxis record{axis.name, names_of(axis.values), {}, {}, {}};
  if (auto sweep = sweep_of(axis)) {
    record.swept = std::move(sweep->name);
    record.numbers = std::move(sweep->numbers);
    record.families = std::move(sweep->families);
  }
  return record;
}

}  // namespace

PlanRecord Grid::record(const std::string& command) const {
  PlanRecord record;
  record.name = plan_.name;
  record.file = plan_.file().name;
  record.command = command;
  record.data_use = plan_.reporting ? "reporting" : "tuning";
  for (const Axis& axis : plan_.axes) record.axes.push_back(axis_record(axis));
  for (const PlannedData& each : plan_.data) {
    record.data.push_back({each.name, names_of(each.sequences)});
    for (const NamedPatch& sequence : each.sequences) record.sequences.push_back(sequence.name);
  }
  record.seeds = plan_.seeds;
  for (const auto& [metric, at] : plan_.show) record.show.push_back(metric);
  for (const PlannedComparison& each : plan_.comparisons) {
    record.comparisons.push_back(each.comparison);
  }
  for (const PlannedExpectation& each : plan_.expect) {
    record.expectations.push_back(each.expectation);
  }
  for (const Cell& cell : cells_) {
    std::vector<std::uint64_t>& seeds = record.seeds;
    if (std::find(seeds.begin(), seeds.end(), cell.seed) == seeds.end()) seeds.push_back(cell.seed);
    PlanCell& entry = record.cells.emplace_back();
    entry.index = static_cast<std::int64_t>(record.cells.size()) - 1;
    for (const Axis& axis : plan_.axes) entry.values.push_back(value_of(cell, axis.name));
    entry.sequence = value_of(cell, "sequence");
    entry.seed = cell.seed;
    entry.key = cell.identity.key;
    entry.group = cell.identity.group;
  }
  return record;
}

}  // namespace weft::lab
