// SPDX-License-Identifier: Apache-2.0
#include "lab/ablation/forecast.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>
#include <weft/core/statistics.hpp>

namespace weft::lab {
namespace {

std::vector<ValueProgress> progress_of(const std::string& axis, const Results& results) {
  std::vector<ValueProgress> values;
  for (const PlanCell& cell : results.plan.cells) {
    const std::string name = results.plan.value_of(cell, axis);
    auto value = std::find_if(values.begin(), values.end(),
                              [&](const ValueProgress& each) { return each.name == name; });
    if (value == values.end()) value = values.insert(value, {name, 0, 0});
    ++value->cells;
    if (results.record(cell).outcome != CellOutcome::missing) ++value->finished;
  }
  return values;
}

}  // namespace

double bytes_in(const std::string& folder) {
  namespace fs = std::filesystem;
  double bytes = 0.0;
  std::error_code code;
  for (fs::recursive_directory_iterator entry(folder, code), end; !code && entry != end;
       entry.increment(code)) {
    std::error_code of_file;
    const auto size = entry->is_regular_file(of_file) ? entry->file_size(of_file) : 0;
    if (!of_file) bytes += static_cast<double>(size);
  }
  return bytes;
}

Forecast forecast(const AblationState& state, double bytes, int jobs) {
  const Results& results = state.results;
  Forecast found;
  for (const PlanAxis& axis : results.plan.axes) {
    found.axes.emplace_back(axis.name, progress_of(axis.name, results));
  }
  found.axes.emplace_back("data", progress_of("data", results));
  std::set<std::string> keys;
  for (const PlanCell& cell : results.plan.cells) {
    const bool is_new = keys.insert(cell.key).second;
    if (is_new && results.record(cell).outcome == CellOutcome::missing) ++found.missing;
  }
  found.finished = results.records.cells.size();
  if (found.finished == 0) return found;
  std::vector<double> seconds;
  for (const auto& [key, record] : results.records.cells) {
    if (std::isfinite(record.seconds)) seconds.push_back(record.seconds);
  }
  const auto missing = static_cast<double>(found.missing);
  if (!seconds.empty()) found.seconds_left = mean(seconds) * missing / jobs;
  found.bytes_left = bytes * missing / static_cast<double>(found.finished);
  return found;
}

}  // namespace weft::lab
