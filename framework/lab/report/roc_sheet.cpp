// SPDX-License-Identifier: Apache-2.0
#include "lab/report/curves.hpp"
#include "lab/report/sheets.hpp"

namespace weft::lab {
namespace {

constexpr const char* kNote =
    "A curve is made of the means over all frames at each value of a threshold. AUC: trapezoids, "
    "with (0, 0) and (100, 100) added; the partial one ends at an FPR of 10 % and is a share of "
    "what it could be. Positive is a rejected match.";

}  // namespace

TextTable roc_sheet(const Results& results, const ReportTables& tables) {
  TextTable table{"roc", "ROC curves", kNote, {}, {}};
  for (const Sweep& sweep : sweeps_of(results, tables)) {
    if (sweep.stage.empty()) continue;
    if (table.columns.empty()) {
      for (const PlanAxis& axis : results.plan.axes)
        table.columns.push_back({axis.name, axis.name});
      for (const TextColumn& column :
           {TextColumn{"stage", "stage"}, TextColumn{"threshold", "threshold"},
            TextColumn{"AUC, %", "auc_percent", true},
            TextColumn{"to FPR 10 %, %", "partial_auc_percent", true},
            TextColumn{"points", "points", true}}) {
        table.columns.push_back(column);
      }
    }
    const PlanAxis& swept = results.plan.axes[sweep.axis];
    for (const SweepCurve& curve : sweep.curves) {
      std::vector<std::string> values = curve.others;
      if (swept.families.empty()) {
        values.insert(values.begin() + static_cast<std::ptrdiff_t>(sweep.axis), "");
      }
      TextRow row;
      for (const std::string& value : values) row.cells.push_back(text_cell(value));
      for (const TextCell& figure :
           {text_cell(sweep.stage), text_cell(swept.swept), number_cell(curve.auc_percent, 2),
            number_cell(curve.partial_auc_percent, 2),
            count_cell(static_cast<std::int64_t>(curve.values.size()))}) {
        row.cells.push_back(figure);
      }
      table.rows.push_back(std::move(row));
    }
  }
  return table;
}

}  // namespace weft::lab
