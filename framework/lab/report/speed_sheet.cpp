// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "lab/report/sheets.hpp"

namespace weft::lab {
namespace {

constexpr const char* kSpeedNote =
    "CPU time of all stages in a frame, the source not counted, of cells that ran alone with "
    "nothing shared; means over sequences, each the mean over its seeds. Frames a second: frames "
    "that fit into a second of one processor core; threads and devices work beside it.";

}  // namespace

TextTable speed_sheet(const Results& results, const ReportTables& tables) {
  TextTable table{"speed", "Time against accuracy", kSpeedNote, {}, {}};
  for (const PlanAxis& axis : results.plan.axes) {
    table.columns.push_back({axis.name, axis.name, false, "", true});
  }
  table.columns.push_back({"mean, mm", "mean_mm", true});
  table.columns.push_back({"processor, ms a frame", "processor_ms", true});
  table.columns.push_back({"frames a second", "frames_per_second", true});
  for (const Combination& combination : tables.combinations) {
    if (!std::isfinite(combination.processor_ms)) continue;
    TextRow row;
    for (const std::string& value : combination.values) row.cells.push_back(text_cell(value));
    row.cells.push_back(number_cell(combination.mean_mm, 2));
    row.cells.push_back(number_cell(combination.processor_ms, 1));
    row.cells.push_back(number_cell(1000.0 / combination.processor_ms, 0));
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace weft::lab
