// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <weft/core/statistics.hpp>
#include <weft/evaluation/report_tables.hpp>

namespace weft::evaluation {
namespace {

/// What a cell has under a name that expectations select by.
std::string value_of(const Results& results, const PlanCell& cell, const std::string& name) {
  for (std::size_t axis = 0; axis < results.axes.size(); ++axis) {
    if (results.axes[axis].name == name) return cell.values[axis];
  }
  if (name == "sequence") return cell.sequence;
  if (name == "seed") return std::to_string(cell.seed);
  const auto data = results.data_of.find(cell.sequence);
  return name == "data" && data != results.data_of.end() ? data->second : "";
}

bool selects(const PlanExpectation& expectation, const Results& results, const PlanCell& cell) {
  return std::all_of(expectation.where.begin(), expectation.where.end(),
                     [&](const auto& condition) {
                       return value_of(results, cell, condition.first) == condition.second;
                     });
}

}  // namespace

ExpectationRow check(const Results& results, const PlanExpectation& expectation) {
  ExpectationRow row;
  for (const auto& [name, value] : expectation.where) {
    row.where += (row.where.empty() ? "" : ", ") + name + ": " + value;
  }
  std::vector<double> figures;
  for (const PlanCell& cell : results.cells) {
    if (!selects(expectation, results, cell)) continue;
    ++row.cells;
    const double figure = results.record(cell).figure(expectation.metric);
    if (std::isfinite(figure)) {
      figures.push_back(figure);
    } else {
      ++row.without;
    }
  }
  row.measured = mean(figures);
  row.met = row.cells > 0 && row.without == 0 && !(row.measured < expectation.at_least) &&
            !(row.measured > expectation.at_most);
  return row;
}

std::string unit_of(const std::string& metric) {
  for (const auto& [ending, unit] : {std::pair{"_mm", "mm"}, std::pair{"_px", "px"},
                                     std::pair{"_percent", "%"}, std::pair{"_ms", "ms"}}) {
    if (metric.ends_with(ending)) return unit;
  }
  return "";
}

}  // namespace weft::evaluation
