// SPDX-License-Identifier: Apache-2.0
#include "lab/results/expectations.hpp"

#include <cmath>
#include <vector>
#include <weft/core/statistics.hpp>

namespace weft::lab {
namespace {

/// Why a cell has no such figure; empty: it has one.
std::string why_without(const CellRecord& record, double figure) {
  if (record.failed()) return "a cell failed: " + record.reason;
  if (!record.done()) return "a cell is not finished";
  return std::isfinite(figure) ? "" : "a cell has no such figure";
}

}  // namespace

ExpectationOutcome judge(const Results& results, const PlanExpectation& expectation) {
  ExpectationOutcome outcome;
  std::vector<double> figures;
  for (const PlanCell& cell : results.plan.cells) {
    if (!results.plan.selects(expectation.where, cell)) continue;
    ++outcome.cells;
    const CellRecord& record = results.record(cell);
    const double figure = record.figure(expectation.metric);
    const std::string why = why_without(record, figure);
    if (why.empty()) {
      figures.push_back(figure);
      continue;
    }
    ++outcome.without;
    if (outcome.why_not.empty()) outcome.why_not = why;
  }
  if (outcome.cells == 0) outcome.why_not = "no cell is selected";
  outcome.mean = mean(figures);
  outcome.met = outcome.why_not.empty() && !(outcome.mean < expectation.at_least) &&
                !(outcome.mean > expectation.at_most);
  return outcome;
}

std::string to_text(const Selection& where) {
  std::string text;
  for (const auto& [name, value] : where) text += (text.empty() ? "" : ", ") + name + "=" + value;
  return text;
}

}  // namespace weft::lab
