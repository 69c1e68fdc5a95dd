// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <weft/core/statistics.hpp>
#include <weft/evaluation/ablation.hpp>

#include "cell_figures.hpp"

namespace weft::evaluation {
namespace {

constexpr std::size_t kMostCombinations = 40;

Verdict judge_one(const Grid& grid, const Expectation& expectation, CellFigures& figures) {
  Verdict verdict{&expectation, false, 0, kUnknown, {}};
  std::vector<double> values;
  const auto spoil = [&](const std::string& reason) {
    if (verdict.why_not.empty()) verdict.why_not = reason;
  };
  for (const Cell& cell : grid.cells()) {
    if (!grid.selects(expectation.where, cell)) continue;
    ++verdict.cells;
    const StoredCell* stored = figures.find(cell);
    if (stored == nullptr || stored->failed) {
      spoil(stored == nullptr ? "a cell is not finished" : "a cell failed: " + stored->reason);
      continue;
    }
    const auto value = figures.at(*stored, expectation.metric);
    if (!value) spoil(value.error().message);
    if (value && std::isnan(*value)) spoil("a cell has no such figure");
    if (value) values.push_back(*value);
  }
  if (verdict.cells == 0) spoil("no cell is selected");
  if (!verdict.why_not.empty()) return verdict;
  verdict.mean = mean(values);
  verdict.met = (!expectation.at_most || verdict.mean <= *expectation.at_most) &&
                (!expectation.at_least || verdict.mean >= *expectation.at_least);
  return verdict;
}

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

/// Number of cells, failures, and a mean for each metric.
Row figures_of(const Grid& grid, const Selection& where, const std::vector<std::string>& metrics,
               CellFigures& figures) {
  std::vector<std::vector<double>> values(metrics.size());
  std::size_t count = 0, failed = 0;
  for (const Cell& cell : grid.cells()) {
    const StoredCell* stored = grid.selects(where, cell) ? figures.find(cell) : nullptr;
    if (stored == nullptr) continue;
    ++count;
    failed += stored->failed ? 1 : 0;
    for (std::size_t i = 0; i < metrics.size() && !stored->failed; ++i) {
      const auto value = figures.at(*stored, metrics[i]);
      if (value && std::isfinite(*value)) values[i].push_back(*value);
    }
  }
  Row row{std::to_string(count), std::to_string(failed)};
  for (const auto& each : values) {
    row.push_back(each.empty() ? "-" : fmt::format("{:.4g}", mean(each)));
  }
  return row;
}

void add_combinations(const Plan& plan, std::size_t axis, Selection& where,
                      std::vector<Selection>& all) {
  if (axis == plan.axes.size()) return all.push_back(where);
  for (const NamedPatch& value : plan.axes[axis].values) {
    where.emplace_back(plan.axes[axis].name, value.name);
    add_combinations(plan, axis + 1, where, all);
    where.pop_back();
  }
}

}  // namespace

std::vector<Verdict> judge(const Grid& grid, const AblationState& state) {
  CellFigures figures(state);
  std::vector<Verdict> verdicts;
  for (const Expectation& each : grid.plan().expect) {
    verdicts.push_back(judge_one(grid, each, figures));
  }
  return verdicts;
}

std::string summary_table(const Grid& grid, const AblationState& state) {
  const Plan& plan = grid.plan();
  const std::vector<std::string> metrics = shown_metrics(plan);
  std::size_t combinations = 1;
  for (const Axis& axis : plan.axes) combinations *= axis.values.size();
  const bool whole = combinations <= kMostCombinations;
  std::vector<Selection> selections;
  Row head;
  if (whole) {
    Selection none;
    add_combinations(plan, 0, none, selections);
    for (const Axis& axis : plan.axes) head.push_back(axis.name);
  } else {
    for (const Axis& axis : plan.axes) {
      for (const NamedPatch& value : axis.values) selections.push_back({{axis.name, value.name}});
    }
    head = {"axis", "value"};
  }
  const std::size_t text_columns = head.size();
  head.insert(head.end(), {"cells", "failed"});
  head.insert(head.end(), metrics.begin(), metrics.end());
  std::vector<Row> rows{head};
  CellFigures figures(state);
  for (const Selection& where : selections) {
    Row& row = rows.emplace_back();
    for (const auto& [name, value] : where) {
      if (!whole) row.push_back(name);
      row.push_back(value);
    }
    const Row numbers = figures_of(grid, where, metrics, figures);
    row.insert(row.end(), numbers.begin(), numbers.end());
  }
  return aligned(rows, text_columns);
}

}  // namespace weft::evaluation
