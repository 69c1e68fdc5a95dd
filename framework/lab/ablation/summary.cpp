// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <weft/core/statistics.hpp>

#include "lab/ablation/ablation.hpp"
#include "lab/metrics/forms/catalogue.hpp"

namespace weft::lab {
namespace {

constexpr std::size_t kMostCombinations = 40;

using Row = std::vector<std::string>;

/// Columns of equal width: text to the left, figures to the right.
std::string aligned(const std::vector<Row>& rows, std::size_t text_columns) {
  std::vector<std::size_t> widths(rows.front().size());
  for (const Row& row : rows) {
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  }
  std::string text;
  for (const Row& row : rows) {
    std::string line;
    for (std::size_t i = 0; i < row.size(); ++i) {
      line += i < text_columns ? fmt::format("{:<{}}  ", row[i], widths[i])
                               : fmt::format("{:>{}}  ", row[i], widths[i]);
    }
    text += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
  }
  return text;
}

/// Number of cells, failures, frames in error where they are wanted, and a mean for each metric.
Row figures_of(const Results& results, const Selection& where,
               const std::vector<std::string>& metrics, bool with_errors) {
  std::vector<std::vector<double>> values(metrics.size());
  std::size_t count = 0, failed = 0;
  std::int64_t frames_in_error = 0;
  for (const PlanCell& cell : results.plan.cells) {
    if (!results.plan.selects(where, cell)) continue;
    const CellRecord& record = results.record(cell);
    if (!record.done() && !record.failed()) continue;
    ++count;
    failed += record.failed() ? 1 : 0;
    frames_in_error += record.frames_in_error;
    for (std::size_t i = 0; i < metrics.size(); ++i) {
      const double value = record.figure(metrics[i]);
      if (std::isfinite(value)) values[i].push_back(value);
    }
  }
  Row row{std::to_string(count), std::to_string(failed)};
  if (with_errors) row.push_back(std::to_string(frames_in_error));
  for (const auto& each : values) {
    row.push_back(each.empty() ? "-" : fmt::format("{:.4g}", mean(each)));
  }
  return row;
}

void add_combinations(const PlanRecord& plan, std::size_t axis, Selection& where,
                      std::vector<Selection>& all) {
  if (axis == plan.axes.size()) return all.push_back(where);
  for (const std::string& value : plan.axes[axis].values) {
    where.emplace_back(plan.axes[axis].name, value);
    add_combinations(plan, axis + 1, where, all);
    where.pop_back();
  }
}

}  // namespace

std::string summary_table(const Results& results) {
  const PlanRecord& plan = results.plan;
  const std::vector<std::string> metrics = plan.shown_metrics();
  std::size_t combinations = 1;
  for (const PlanAxis& axis : plan.axes) combinations *= axis.values.size();
  const bool whole = combinations <= kMostCombinations;
  std::vector<Selection> selections;
  Row head;
  if (whole) {
    Selection none;
    add_combinations(plan, 0, none, selections);
    for (const PlanAxis& axis : plan.axes) head.push_back(axis.name);
  } else {
    for (const PlanAxis& axis : plan.axes) {
      for (const std::string& value : axis.values) selections.push_back({{axis.name, value}});
    }
    head = {"axis", "value"};
  }
  const std::size_t text_columns = head.size();
  head.insert(head.end(), {"cells", "failed"});
  const bool with_errors =
      std::any_of(plan.cells.begin(), plan.cells.end(),
                  [&](const PlanCell& cell) { return results.record(cell).frames_in_error > 0; });
  if (with_errors) head.emplace_back("frames in error");
  for (const std::string& metric : metrics) head.push_back(metric_heading(metric));
  std::vector<Row> rows{head};
  for (const Selection& where : selections) {
    Row& row = rows.emplace_back();
    for (const auto& [name, value] : where) {
      if (!whole) row.push_back(name);
      row.push_back(value);
    }
    const Row numbers = figures_of(results, where, metrics, with_errors);
    row.insert(row.end(), numbers.begin(), numbers.end());
  }
  return aligned(rows, text_columns);
}

}  // namespace weft::lab
