// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "lab/metrics/forms/metric_path.hpp"
#include "lab/report/panel_figures.hpp"
#include "lab/report/sheets.hpp"
#include "lab/statistics/sentence_parts.hpp"

namespace weft::lab {
namespace {

constexpr std::size_t kFewestInMatrix = 3, kMostInMatrix = 12;

constexpr const char* kMatrixNote =
    "Row minus column with the corrected interval and p. Blue: the row is better; orange: the "
    "column is; grey: not decided. A verdict also counts results without a value.";

struct Seen {
  double mean = kUnknown, p = kUnknown;
  Interval interval;
  Call verdict = Call::undecided;
};

/// A pair as a minus b, whichever of the two the table has first.
std::optional<Seen> seen_from(const ComparisonTable& table, const std::string& a,
                              const std::string& b) {
  for (const PairComparison& pair : table.pairs) {
    const Interval& known = pair.interval;
    if (pair.a == a && pair.b == b) {
      return Seen{pair.test.mean, pair.p_holm, known, pair.verdict};
    }
    if (pair.a != b || pair.b != a) continue;
    const Call turned = pair.verdict == Call::a   ? Call::b
                        : pair.verdict == Call::b ? Call::a
                                                  : pair.verdict;
    return Seen{-pair.test.mean, pair.p_holm, {-known.high, -known.low}, turned};
  }
  return std::nullopt;
}

TextCell matrix_cell(const Seen& seen) {
  if (!std::isfinite(seen.mean)) return text_cell("–");
  std::string text = three_digits(seen.mean);
  if (std::isfinite(seen.interval.low)) {
    text += fmt::format("\n[{}, {}]", three_digits(seen.interval.low),
                        three_digits(seen.interval.high));
  }
  if (std::isfinite(seen.p)) text += fmt::format("\np {:.2g}", seen.p);
  TextCell cell = text_cell(text);
  cell.tint = seen.verdict == Call::a ? "better" : seen.verdict == Call::b ? "worse" : "";
  return cell;
}

}  // namespace

TextTable matrix_sheet(const ComparisonResult& comparison) {
  TextTable table{
      "matrix-" + comparison.plan.axis, "Each against each", kMatrixNote, {}, {}, false};
  const ComparisonTable& known = comparison.table;
  if (!comparison.plan.reference.empty() || known.treatments.size() < kFewestInMatrix) return table;
  std::vector<TreatmentSummary> treatments = ranked(known, better_of(comparison.plan.metric));
  if (treatments.size() > kMostInMatrix) treatments.resize(kMostInMatrix);
  const std::string unit = difference_unit(comparison.unit);
  table.columns.push_back({"A − B" + (unit.empty() ? "" : ", " + unit), "a"});
  for (const TreatmentSummary& each : treatments) table.columns.push_back({each.name, each.name});
  for (const TreatmentSummary& row : treatments) {
    TextRow cells{{text_cell(row.name)}};
    for (const TreatmentSummary& column : treatments) {
      const auto seen = seen_from(known, row.name, column.name);
      cells.cells.push_back(seen ? matrix_cell(*seen) : text_cell(""));
    }
    table.rows.push_back(std::move(cells));
  }
  return table;
}

}  // namespace weft::lab
