// SPDX-License-Identifier: Apache-2.0
#include "lab/report/sheets.hpp"

namespace weft::lab {
namespace {

constexpr const char* kCertaintyNote =
    "Of all solved frames with an error. Brier score: mean of (confidence - right)^2, 0 is "
    "perfect. Right: the mean error of what the camera sees is below 2 % of the template's "
    "diagonal. Silently wrong: estimated, and a mean error above 20 mm. Within: vertices whose "
    "error along the major axis of their covariance is at most this number of standard deviations; "
    "of normal errors 68.3, 95.4 and 99.7 %.";

}  // namespace

TextTable certainty_sheet(const Results& results, const ReportTables& tables) {
  TextTable table{"confidence", "Confidence", kCertaintyNote, {}, {}};
  for (const PlanAxis& axis : results.plan.axes) {
    table.columns.push_back({axis.name, axis.name, false, "", true});
  }
  for (const TextColumn& column :
       {TextColumn{"frames", "frames", true},
        TextColumn{"mean confidence", "mean_confidence", true},
        TextColumn{"Brier score", "brier", true}, TextColumn{"right", "right", true},
        TextColumn{"silently wrong", "silently_wrong", true},
        TextColumn{"within 1 std, %", "within_1_std_percent", true},
        TextColumn{"2 std", "within_2_std_percent", true},
        TextColumn{"3 std", "within_3_std_percent", true}}) {
    table.columns.push_back(column);
  }
  for (const Combination& combination : tables.combinations) {
    const CertaintyCounts& certainty = combination.certainty;
    if (certainty.frames == 0) continue;
    TextRow row;
    for (const std::string& value : combination.values) row.cells.push_back(text_cell(value));
    row.cells.push_back(count_cell(certainty.frames));
    row.cells.push_back(number_cell(certainty.confidence(), 2));
    row.cells.push_back(number_cell(certainty.brier(), 3));
    row.cells.push_back(count_cell(certainty.right));
    row.cells.push_back(count_cell(certainty.silently_wrong));
    for (const double percent : certainty.within_percent) {
      row.cells.push_back(number_cell(certainty.vertices > 0 ? percent : kUnknown, 1));
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace weft::lab
