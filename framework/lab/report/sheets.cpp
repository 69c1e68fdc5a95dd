// SPDX-License-Identifier: Apache-2.0
#include "lab/report/sheets.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numeric>

#include "lab/metrics/forms/catalogue.hpp"
#include "lab/metrics/forms/metric_path.hpp"
#include "lab/report/notes.hpp"
#include "lab/report/tables/statistics.hpp"
#include "lab/statistics/sentence_parts.hpp"

namespace weft::lab {
namespace {

constexpr std::size_t kBetterColumn = 5;  ///< column in tables of comparisons

void add_axes(const Results& results, TextTable& table) {
  for (const PlanAxis& axis : results.plan.axes) {
    table.columns.push_back({axis.name, axis.name, false, "", true});
  }
}

/// The values of a combination; the first leads to what reproduces it.
void add_values(const ReportTables& tables, std::size_t index, TextRow& row) {
  const Combination& combination = tables.combinations[index];
  for (const std::string& value : combination.values) row.cells.push_back(text_cell(value));
  if (row.cells.empty() || !combination.detailed) return;
  row.cells.front().link = anchor_of(index);
  row.cells.front().tip = "Settings, keys and commands behind this row";
}

TextCell share_cell(std::int64_t part, std::int64_t whole) {
  TextCell cell{std::to_string(part) + " of " + std::to_string(whole), std::to_string(part)};
  cell.of = std::to_string(whole);
  return cell;
}

TextCell cause_cell(const std::string& cause) { return {cause.empty() ? "–" : cause, cause}; }

void add_error(const Combination& combination, TextRow& row) {
  row.cells.push_back(number_cell(combination.mean_mm, 3));
  row.cells.push_back(number_cell(combination.interval_mm.low, 3));
  row.cells.push_back(number_cell(combination.interval_mm.high, 3));
  row.cells.push_back(number_cell(combination.worst_mm, 3));
  row.cells.back().tip = combination.worst_place;
}

TextRow combination_row(const Results& results, const ReportTables& tables, std::size_t index) {
  const Combination& combination = tables.combinations[index];
  TextRow row{
      {}, combination.selectable ? static_cast<std::ptrdiff_t>(index) : -1, combination.done == 0};
  add_values(tables, index, row);
  if (tables.has_error) add_error(combination, row);
  for (const std::size_t metric : shown_metrics(results, tables)) {
    const bool length = unit_of(results.plan.show[metric]) == "mm";
    row.cells.push_back(number_cell(combination.shown[metric], length ? 3 : 2));
  }
  row.cells.push_back(share_cell(combination.solved, combination.frames));
  row.cells.push_back(share_cell(combination.failures, combination.truth_frames));
  row.cells.push_back(count_cell(combination.frames_in_error));
  row.cells.push_back(cause_cell(combination.first_error));
  const std::int64_t cells = combination.done + combination.failed + combination.missing;
  row.cells.push_back(share_cell(combination.failed, cells));
  row.cells.push_back(share_cell(combination.missing, cells));
  row.cells.push_back(count_cell(combination.sequences));
  row.cells.push_back(text_cell(fmt::format("{}", fmt::join(combination.implements, ", "))));
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
  TextRow row{{text_cell(plan.axis), text_cell(plan.metric),
               text_cell(difference_unit(unit_of(plan.metric))), text_cell(pair.a),
               text_cell(pair.b), text_cell(better_text(pair)), figure_cell(pair.test.mean),
               figure_cell(pair.interval.low), figure_cell(pair.interval.high),
               count_cell(pair.test.n), number_cell(pair.test.p, 4), number_cell(pair.p_holm, 4),
               figure_cell(pair.smallest_effect), count_cell(pair.failures.only_a),
               count_cell(pair.failures.only_b), count_cell(pair.failures.rows)}};
  row.cells[kBetterColumn].tip = pair.sentence;
  return row;
}

}  // namespace

std::vector<std::size_t> shown_metrics(const Results& results, const ReportTables& tables) {
  std::vector<std::size_t> metrics;
  for (std::size_t m = 0; m < results.plan.show.size(); ++m) {
    if (!tables.has_error || results.plan.show[m] != kErrorMetric) metrics.push_back(m);
  }
  return metrics;
}

TextTable combinations_sheet(const Results& results, const ReportTables& tables) {
  TextTable table{"combinations", "Results", combinations_note(results, tables), {}, {}};
  add_axes(results, table);
  if (tables.has_error) {
    for (const TextColumn& column :
         {TextColumn{"mean, mm", "mean_mm", true}, TextColumn{"95 % from", "low_mm", true},
          TextColumn{"to", "high_mm", true}, TextColumn{"worst, mm", "worst_mm", true}}) {
      table.columns.push_back(column);
    }
  }
  for (const std::size_t metric : shown_metrics(results, tables)) {
    const std::string& path = results.plan.show[metric];
    table.columns.push_back({metric_heading(path), path, true});
  }
  for (const TextColumn& column :
       {TextColumn{"frames solved", "frames_solved", true, "frames", true},
        TextColumn{"frames failed", "frames_failed", true, "frames_with_truth", true},
        TextColumn{"frames in error", "frames_in_error", true, "", true},
        TextColumn{"first error", "first_error", false, "", true},
        TextColumn{"cells failed", "cells_failed", true, "cells", true},
        TextColumn{"not run", "cells_missing", true, "", true},
        TextColumn{"n", "sequences", true, "", true},
        TextColumn{"implements", "implements", false, "", true},
        TextColumn{"reads the truth", "uses_truth", false, "", true}}) {
    table.columns.push_back(column);
  }
  for (std::size_t i = 0; i < tables.combinations.size(); ++i) {
    table.rows.push_back(combination_row(results, tables, i));
  }
  return table;
}

TextTable comparison_sheet(const std::vector<ComparisonResult>& comparisons) {
  TextTable table{"comparisons",
                  "Comparisons",
                  comparisons_note(),
                  {{"axis", "axis"},
                   {"metric", "metric", false, "", true},
                   {"unit", "unit", false, "", true},
                   {"A", "a"},
                   {"B", "b"},
                   {"better", "better"},
                   {"A − B", "difference", true},
                   {"95 % from", "low", true},
                   {"to", "high", true},
                   {"n", "sequences", true, "", true},
                   {"p", "p", true},
                   {"p, Holm", "p_holm", true},
                   {"smallest effect", "smallest_effect", true},
                   {"no value only A", "only_a_failed", true, "", true},
                   {"only B", "only_b_failed", true, "", true},
                   {"of", "places", true, "", true}},
                  {}};
  for (const ComparisonResult& comparison : comparisons) {
    for (const PairComparison& pair : comparison.table.pairs) {
      table.rows.push_back(comparison_row(comparison.plan, pair));
    }
  }
  return table;
}

TextTable expectations_sheet(const Results& results, const ReportTables& tables) {
  TextTable table{"expectations",
                  "Expectations",
                  expectations_note(),
                  {{"where", "where"},
                   {"metric", "metric"},
                   {"at least", "at_least", true},
                   {"at most", "at_most", true},
                   {"measured", "measured", true},
                   {"cells", "cells", true},
                   {"without it", "cells_without", true, "", true},
                   {"met", "met"}},
                  {}};
  for (std::size_t i = 0; i < tables.expectations.size(); ++i) {
    const PlanExpectation& plan = results.plan.expectations[i];
    const ExpectationOutcome& outcome = tables.expectations[i];
    table.rows.push_back(
        {{text_cell(to_text(plan.where)), text_cell(plan.metric), number_cell(plan.at_least, 3),
          number_cell(plan.at_most, 3), number_cell(outcome.mean, 3), count_cell(outcome.cells),
          count_cell(outcome.without), text_cell(outcome.met ? "yes" : "no")},
         -1,
         !outcome.met});
  }
  return table;
}

TextTable filters_sheet(const Results& results, const ReportTables& tables) {
  TextTable table{"filters", "Filters", filters_note(results), {}, {}};
  add_axes(results, table);
  for (const TextColumn& column :
       {TextColumn{"stage", "stage", false, "", true}, TextColumn{"TPR, %", "tpr_percent", true},
        TextColumn{"FPR, %", "fpr_percent", true}, TextColumn{"kept, %", "kept_percent", true},
        TextColumn{"precision, %", "precision_percent", true},
        TextColumn{"matches", "entered", true}, TextColumn{"mismatches", "mismatches", true},
        TextColumn{"n", "sequences", true, "", true}}) {
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
  TextTable table{"times", "Time of each stage", times_note(), {}, {}};
  add_axes(results, table);
  table.columns.push_back({"stage", "stage"});
  table.columns.push_back({"mean, ms a frame", "mean_ms", true});
  table.columns.push_back({"median, ms", "median_ms", true});
  table.columns.push_back({"processor, ms a frame", "mean_processor_ms", true});
  for (std::size_t i = 0; i < tables.combinations.size(); ++i) {
    for (const StageTime& time : tables.combinations[i].times) {
      TextRow row;
      add_values(tables, i, row);
      row.cells.push_back(text_cell(time.stage));
      row.cells.push_back(number_cell(time.mean_ms, 2));
      row.cells.push_back(number_cell(time.median_ms, 2));
      row.cells.push_back(number_cell(time.mean_processor_ms, 2));
      table.rows.push_back(std::move(row));
    }
  }
  return table;
}

TextTable cells_sheet(const Results& results, const std::vector<std::size_t>& cells) {
  TextTable table{"cells", "Cells", cells_note(results), {{"cell", "cell", true}}, {}};
  add_axes(results, table);
  for (const TextColumn& column :
       {TextColumn{"sequence", "sequence"}, TextColumn{"seed", "seed", true},
        TextColumn{"outcome", "outcome", false, "", true}, TextColumn{"mean, mm", "mean_mm", true},
        TextColumn{"worst, mm", "worst_mm", true},
        TextColumn{"solved", "frames_solved", true, "frames"},
        TextColumn{"failed", "frames_failed", true, "frames_with_truth"},
        TextColumn{"in error", "frames_in_error", true, "", true},
        TextColumn{"first error", "first_error", false, "", true},
        TextColumn{"reason", "reason", false, "", true}, TextColumn{"key", "key"}}) {
    table.columns.push_back(column);
  }
  table.rows.reserve(cells.size());  // 10,000, or a million
  for (const std::size_t index : cells) {
    const PlanCell& cell = results.plan.cells[index];
    const CellRecord& record = results.record(cell);
    const SequenceSize size = results.size(cell);
    TextRow row{{}, -1, record.outcome == CellOutcome::failed};
    row.cells.reserve(table.columns.size());
    row.cells.push_back(count_cell(cell.index));
    for (const std::string& value : cell.values) row.cells.push_back(text_cell(value));
    for (const TextCell& figure :
         {text_cell(cell.sequence), text_cell(std::to_string(cell.seed)),
          text_cell(to_string(record.outcome)), number_cell(record.mean_mm, 3),
          number_cell(record.worst_mm, 3), share_cell(record.solved, size.frames),
          share_cell(record.failures + size.truth_frames - record.truth_frames, size.truth_frames),
          count_cell(record.frames_in_error), cause_cell(record.first_error),
          text_cell(record.reason), text_cell(cell.key)}) {
      row.cells.push_back(figure);
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

std::vector<TextTable> all_sheets(const Results& results, const ReportTables& tables) {
  std::vector<std::size_t> every(results.plan.cells.size());
  std::iota(every.begin(), every.end(), 0);
  std::vector<TextTable> sheets;
  const auto add = [&sheets](TextTable table) {
    if (!table.rows.empty()) sheets.push_back(std::move(table));
  };
  add(combinations_sheet(results, tables));
  add(comparison_sheet(tables.comparisons));
  add(expectations_sheet(results, tables));
  add(filters_sheet(results, tables));
  add(roc_sheet(results, tables));
  add(certainty_sheet(results, tables));
  add(speed_sheet(results, tables));
  add(times_sheet(results, tables));
  add(cells_sheet(results, every));
  return sheets;
}

}  // namespace weft::lab
