// SPDX-License-Identifier: Apache-2.0
#include "report_sheets.hpp"

#include <cmath>
#include <numeric>

namespace weft::evaluation {
namespace {

void add_axes(const Results& results, TextTable& table) {
  for (const PlanAxis& axis : results.axes) table.columns.push_back({axis.name, axis.name});
}

/// The values of a combination; the first leads to what reproduces it.
void add_values(const ReportTables& tables, std::size_t index, TextRow& row) {
  const Combination& combination = tables.combinations[index];
  for (const std::string& value : combination.values) row.cells.push_back(text_cell(value));
  if (row.cells.empty()) return;
  row.cells.front().link = anchor_of(index);
  row.cells.front().tip = "Settings, keys and commands behind this row";
}

TextCell share_cell(std::int64_t part, std::int64_t whole) {
  return {std::to_string(part) + " of " + std::to_string(whole), std::to_string(part)};
}

void add_error(const Combination& combination, TextRow& row) {
  row.cells.push_back(number_cell(combination.mean_mm, 2));
  row.cells.push_back(number_cell(combination.interval_mm.low, 2));
  row.cells.push_back(number_cell(combination.interval_mm.high, 2));
  row.cells.push_back(number_cell(combination.worst_mm, 2));
  row.cells.back().tip = combination.worst_place;
}

TextRow combination_row(const ReportTables& tables, std::size_t index) {
  const Combination& combination = tables.combinations[index];
  const bool drawable = std::isfinite(combination.mean_mm);
  TextRow row{{}, drawable ? static_cast<std::ptrdiff_t>(index) : -1, combination.done == 0};
  add_values(tables, index, row);
  if (tables.has_error) add_error(combination, row);
  for (const double figure : combination.shown) row.cells.push_back(number_cell(figure, 2));
  row.cells.push_back(share_cell(combination.solved, combination.frames));
  row.cells.push_back(share_cell(combination.failures, combination.truth_frames));
  const std::int64_t cells = combination.done + combination.failed + combination.missing;
  row.cells.push_back(share_cell(combination.failed, cells));
  row.cells.push_back(share_cell(combination.missing, cells));
  row.cells.push_back(count_cell(combination.sequences));
  row.cells.push_back(text_cell(combination.uses_truth ? "yes" : "no"));
  return row;
}

std::string better_text(const PairComparison& pair) {
  switch (pair.verdict) {
    case Call::a:
      return pair.a;
    case Call::b:
      return pair.b;
    case Call::undecided:
      return "undecided";
    default:
      return "too few to decide";
  }
}

TextRow comparison_row(const PlanComparison& plan, const PairComparison& pair) {
  TextRow row{{text_cell(plan.axis), text_cell(plan.metric), text_cell(pair.a), text_cell(pair.b),
               number_cell(pair.test.mean, 3), number_cell(pair.test.interval.low, 3),
               number_cell(pair.test.interval.high, 3), count_cell(pair.test.n),
               number_cell(pair.test.p, 4), number_cell(pair.p_holm, 4),
               number_cell(pair.smallest_effect, 3), count_cell(pair.failures.only_a),
               count_cell(pair.failures.only_b), count_cell(pair.failures.rows),
               text_cell(better_text(pair))}};
  row.cells.back().tip = pair.sentence;
  return row;
}

/// A path as a shell takes it.
std::string in_shell(const std::string& path) {
  constexpr const char* kPlain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789/._-+=:,@%";
  if (path.find_first_not_of(kPlain) == std::string::npos) return path;
  std::string quoted = "'";
  for (const char c : path) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

}  // namespace

std::string anchor_of(std::size_t combination) {
  return "reproduce-" + std::to_string(combination);
}

std::string command_of(const Results& results, const PlanCell& cell) {
  return "weft run " + in_shell(results.folder + "/cells/" + cell.key + "/pipeline.yaml");
}

TextTable combinations_sheet(const Results& results, const ReportTables& tables) {
  TextTable table{"combinations", "Results", "", {}, {}};
  add_axes(results, table);
  if (tables.has_error) {
    for (const TextColumn& column :
         {TextColumn{"mean, mm", "mean_mm", true}, TextColumn{"95 % from", "low_mm", true},
          TextColumn{"to", "high_mm", true}, TextColumn{"worst, mm", "worst_mm", true}}) {
      table.columns.push_back(column);
    }
  }
  for (const std::string& metric : results.show) table.columns.push_back({metric, metric, true});
  for (const TextColumn& column :
       {TextColumn{"frames solved", "frames_solved", true},
        TextColumn{"frames failed", "frames_failed", true},
        TextColumn{"cells failed", "cells_failed", true},
        TextColumn{"not run", "cells_missing", true}, TextColumn{"n", "sequences", true},
        TextColumn{"reads the truth", "uses_truth"}}) {
    table.columns.push_back(column);
  }
  for (std::size_t i = 0; i < tables.combinations.size(); ++i) {
    table.rows.push_back(combination_row(tables, i));
  }
  return table;
}

TextTable comparison_sheet(const std::vector<ComparisonResult>& comparisons) {
  TextTable table{"comparisons",
                  "Comparisons",
                  "",
                  {{"axis", "axis"},
                   {"metric", "metric"},
                   {"A", "a"},
                   {"B", "b"},
                   {"A − B", "difference", true},
                   {"95 % from", "low", true},
                   {"to", "high", true},
                   {"n", "sequences", true},
                   {"p", "p", true},
                   {"p, Holm", "p_holm", true},
                   {"smallest effect", "smallest_effect", true},
                   {"fails only A", "only_a_failed", true},
                   {"only B", "only_b_failed", true},
                   {"of", "places", true},
                   {"better", "better"}},
                  {}};
  for (const auto& [plan, unit, result] : comparisons) {
    for (const PairComparison& pair : result.pairs) {
      table.rows.push_back(comparison_row(plan, pair));
    }
  }
  return table;
}

TextTable expectations_sheet(const Results& results, const ReportTables& tables) {
  TextTable table{"expectations",
                  "Expectations",
                  "",
                  {{"where", "where"},
                   {"metric", "metric"},
                   {"at least", "at_least", true},
                   {"at most", "at_most", true},
                   {"measured", "measured", true},
                   {"cells", "cells", true},
                   {"without it", "cells_without", true},
                   {"met", "met"}},
                  {}};
  for (std::size_t i = 0; i < tables.expectations.size(); ++i) {
    const PlanExpectation& plan = results.expectations[i];
    const ExpectationRow& row = tables.expectations[i];
    table.rows.push_back(
        {{text_cell(row.where), text_cell(plan.metric), number_cell(plan.at_least, 2),
          number_cell(plan.at_most, 2), number_cell(row.measured, 3), count_cell(row.cells),
          count_cell(row.without), text_cell(row.met ? "yes" : "no")},
         -1,
         !row.met});
  }
  return table;
}

TextTable filters_sheet(const Results& results, const ReportTables& tables) {
  TextTable table{"filters", "Filters", "", {}, {}};
  add_axes(results, table);
  for (const TextColumn& column :
       {TextColumn{"stage", "stage"}, TextColumn{"TPR, %", "tpr_percent", true},
        TextColumn{"FPR, %", "fpr_percent", true}, TextColumn{"kept, %", "kept_percent", true},
        TextColumn{"precision, %", "precision_percent", true},
        TextColumn{"matches", "entered", true}, TextColumn{"mismatches", "mismatches", true},
        TextColumn{"n", "sequences", true}}) {
    table.columns.push_back(column);
  }
  for (std::size_t i = 0; i < tables.combinations.size(); ++i) {
    for (const auto& [rates, sequences] : tables.combinations[i].filters) {
      TextRow row;
      add_values(tables, i, row);
      for (const TextCell& cell :
           {text_cell(rates.stage), number_cell(rates.tpr_percent, 1),
            number_cell(rates.fpr_percent, 1), number_cell(rates.kept_percent, 1),
            number_cell(rates.precision_percent, 1), count_cell(rates.entered),
            count_cell(rates.mismatches), count_cell(sequences)}) {
        row.cells.push_back(cell);
      }
      table.rows.push_back(std::move(row));
    }
  }
  return table;
}

TextTable times_sheet(const Results& results, const ReportTables& tables) {
  TextTable table{"times", "Time of each stage", "", {}, {}};
  add_axes(results, table);
  table.columns.push_back({"stage", "stage"});
  table.columns.push_back({"mean, ms a frame", "mean_ms", true});
  table.columns.push_back({"median, ms", "median_ms", true});
  for (std::size_t i = 0; i < tables.combinations.size(); ++i) {
    for (const StageTime& time : tables.combinations[i].times) {
      TextRow row;
      add_values(tables, i, row);
      row.cells.push_back(text_cell(time.stage));
      row.cells.push_back(number_cell(time.mean_ms, 2));
      row.cells.push_back(number_cell(time.median_ms, 2));
      table.rows.push_back(std::move(row));
    }
  }
  return table;
}

TextTable cells_sheet(const Results& results, const std::vector<std::size_t>& cells) {
  TextTable table{"cells", "Cells", "", {{"cell", "cell", true}}, {}};
  add_axes(results, table);
  for (const TextColumn& column :
       {TextColumn{"sequence", "sequence"}, TextColumn{"seed", "seed", true},
        TextColumn{"outcome", "outcome"}, TextColumn{"mean, mm", "mean_mm", true},
        TextColumn{"worst, mm", "worst_mm", true}, TextColumn{"solved", "frames_solved", true},
        TextColumn{"failed", "frames_failed", true}, TextColumn{"reason", "reason"},
        TextColumn{"key", "key"}}) {
    table.columns.push_back(column);
  }
  for (const std::size_t index : cells) {
    const PlanCell& cell = results.cells[index];
    const CellRecord& record = results.record(cell);
    TextRow row{{count_cell(cell.index)}, -1, record.outcome == CellOutcome::failed};
    for (const std::string& value : cell.values) row.cells.push_back(text_cell(value));
    for (const TextCell& figure :
         {text_cell(cell.sequence), text_cell(std::to_string(cell.seed)),
          text_cell(to_string(record.outcome)), number_cell(record.mean_mm, 3),
          number_cell(record.worst_mm, 3), share_cell(record.solved, record.frames),
          share_cell(record.failures, record.truth_frames), text_cell(record.reason),
          text_cell(cell.key)}) {
      row.cells.push_back(figure);
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

std::vector<TextTable> all_sheets(const Results& results, const ReportTables& tables) {
  std::vector<std::size_t> every(results.cells.size());
  std::iota(every.begin(), every.end(), 0);
  std::vector<TextTable> sheets;
  for (TextTable& table :
       std::vector{combinations_sheet(results, tables), comparison_sheet(tables.comparisons),
                   expectations_sheet(results, tables), filters_sheet(results, tables),
                   times_sheet(results, tables), cells_sheet(results, every)}) {
    if (!table.rows.empty()) sheets.push_back(std::move(table));
  }
  return sheets;
}

}  // namespace weft::evaluation
