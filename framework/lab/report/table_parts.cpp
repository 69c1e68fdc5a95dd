// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "lab/metrics/forms/catalogue.hpp"
#include "lab/report/notes.hpp"
#include "lab/report/panel_figures.hpp"
#include "lab/report/parts.hpp"
#include "lab/report/sheets.hpp"
#include "lab/report/text/page.hpp"

namespace weft::lab {
namespace {

/// The failed cells of a combination, each with its reason.
std::string failures_of(const Results& results, const Combination& combination) {
  std::map<std::string, std::int64_t> reasons;
  for (const std::size_t index : combination.cells) {
    const CellRecord& record = results.record(results.plan.cells[index]);
    if (record.outcome == CellOutcome::failed) ++reasons[record.reason];
  }
  std::string text;
  for (const auto& [reason, count] : reasons) {
    text += fmt::format("<p class=\"failures\">{} failed: {}</p>\n", count, html_escaped(reason));
  }
  return text;
}

/// Sentences on each pair and on all pairs together.
std::string sentences_of(const ComparisonTable& table) {
  constexpr std::size_t kMostSentences = 100;
  std::string text = "<ul class=\"small\">\n";
  if (table.friedman) text += "<li>" + html_escaped(table.friedman->sentence) + "</li>\n";
  for (std::size_t i = 0; i < std::min(table.pairs.size(), kMostSentences); ++i) {
    text += "<li>" + html_escaped(table.pairs[i].sentence) + "</li>\n";
  }
  return text + "</ul>\n";
}

/// The rows of a comparison without the columns that its heading contains.
TextTable without_heading(const ComparisonResult& comparison) {
  constexpr std::ptrdiff_t kHeading = 3;  // axis, metric and unit
  TextTable table = comparison_sheet({comparison});
  table.note.clear();
  table.columns.erase(table.columns.begin(), table.columns.begin() + kHeading);
  for (TextRow& row : table.rows) row.cells.erase(row.cells.begin(), row.cells.begin() + kHeading);
  return table;
}

/// The effective settings of a cell, where its folder has them.
std::string settings_of(const Results& results, const PlanCell& cell) {
  const std::string settings =
      text_of_file(results.folder + "/cells/" + cell.key + "/pipeline.yaml");
  if (settings.empty()) return "";
  return "<details><summary>Its effective settings</summary><pre>" + html_escaped(settings) +
         "</pre></details>\n";
}

std::string speed_part(const Results& results, const ReportTables& tables, bool scripted) {
  const TextTable sheet = speed_sheet(results, tables);
  if (sheet.rows.empty()) return "";
  const char* figure =
      "<figure id=\"figure-speed\"><div class=\"plot\"></div>\n"
      "<figcaption>Better is up and to the left. Filled, on the broken line: no other is both as "
      "fast and as accurate. The lines through the points are the 95 % intervals of the "
      "errors.</figcaption></figure>\n";
  return std::string("<h3>Time against accuracy</h3>\n") + (scripted ? figure : "") +
         to_html(sheet) + "<h3>By stage</h3>\n";
}

std::string items_html(const std::vector<std::string>& texts) {
  std::string text = "<ul>\n";
  for (const std::string& each : texts) text += "<li>" + html_escaped(each) + "</li>\n";
  return text + "</ul>\n";
}

/// The verdict, what contradicts it on other axes, and, folded if it is long, what confirms it.
std::string verdict_html(const Verdict& verdict) {
  constexpr std::size_t kMostOpen = 6;
  std::string text = "<div class=\"verdict\">\n";
  if (!verdict.about.empty()) text += "<h3>" + html_escaped(verdict.about) + "</h3>\n";
  text += "<p>" + html_escaped(verdict.text) + "</p>\n";
  if (!verdict.unlike.empty()) text += items_html(verdict.unlike);
  if (verdict.like.empty()) return text + "</div>\n";
  if (verdict.unlike.size() + verdict.like.size() <= kMostOpen) {
    return text + items_html(verdict.like) + "</div>\n";
  }
  return text +
         fmt::format("<details><summary>The same verdict in {}</summary>{}</details></div>\n",
                     counted(verdict.like.size(), "part"), items_html(verdict.like));
}

bool lists_every_cell(const ReportTables& tables) {
  return std::all_of(tables.combinations.begin(), tables.combinations.end(),
                     [](const Combination& each) { return each.detailed; });
}

}  // namespace

std::string verdicts_part(const Results& results, const ReportTables& tables) {
  std::string text;
  const std::vector<Verdict> verdicts = verdicts_of(tables);
  for (std::size_t i = 0; i < verdicts.size(); ++i) {
    const PanelFigure ranking =
        i < tables.comparisons.size()          ? ranking_figure(tables.comparisons[i])
        : tables.comparisons.empty() && i == 0 ? ranking_figure(results, tables)
                                               : PanelFigure{};
    text += "<div class=\"standing\">\n" + to_html(ranking, paper_note(results.folder)) +
            verdict_html(verdicts[i]) + "</div>\n";
  }
  for (const std::string& notice : notices_of(results, tables)) {
    text += "<p class=\"notice\">" + html_escaped(notice) + "</p>\n";
  }
  return text;
}

std::string compared_part(const Results& results, const ReportTables& tables) {
  return facts_html(facts_of(results, tables), results.plan.command);
}

std::string results_part(const Results& results, const ReportTables& tables) {
  TextTable sheet = combinations_sheet(results, tables);
  // The page of a large plan has the beginning of the table.
  if (!lists_every_cell(tables)) {
    std::stable_partition(sheet.rows.begin(), sheet.rows.end(),
                          [](const TextRow& row) { return row.treatment >= 0; });
  }
  return to_html(std::move(sheet)) +
         "<p class=\"small muted\">A row's first value leads to its cells, their settings and "
         "commands.</p>\n";
}

std::string comparisons_part(const Results& results, const ReportTables& tables) {
  std::string text;
  for (const ComparisonResult& comparison : tables.comparisons) {
    if (comparison.table.pairs.empty()) continue;
    text += fmt::format("<h3>{}: {}</h3>\n", html_escaped(comparison.plan.axis),
                        html_escaped(metric_name(comparison.plan.metric)));
    const TextTable matrix = matrix_sheet(comparison);
    if (!matrix.rows.empty()) text += "<h4>Each against each</h4>\n" + to_html(matrix);
    text += to_html(differences_figure(comparison), paper_note(results.folder));
    for (const SeparateComparison& axis : comparison.separate) {
      const std::string figure =
          to_html(conditions_figure(comparison, axis), paper_note(results.folder));
      if (!figure.empty()) text += "<h4>By " + html_escaped(axis.axis) + "</h4>\n" + figure;
    }
    const std::string scenes = to_html(scenes_figure(comparison), paper_note(results.folder));
    if (!scenes.empty()) text += "<h4>By sequence</h4>\n" + scenes;
    text += to_html(without_heading(comparison)) + sentences_of(comparison.table);
  }
  if (text.empty()) return text;
  return text + "<p class=\"small muted\">" + html_escaped(comparisons_note()) + "</p>\n";
}

std::string expectations_part(const Results& results, const ReportTables& tables) {
  if (tables.expectations.empty()) return "";
  return to_html(expectations_sheet(results, tables));
}

std::string filters_part(const Results& results, const ReportTables& tables) {
  if (tables.filter_stages.empty()) return "";
  std::string text;
  for (const std::string& stage : tables.filter_stages) {
    text += to_html(rates_figure(tables, stage), paper_note(results.folder));
  }
  return text + to_html(filters_sheet(results, tables));
}

std::string times_part(const Results& results, const ReportTables& tables, bool scripted) {
  if (!tables.has_times) {
    return "<p>No times: the stages of these runs were shared and cached between cells, so that "
           "their times would mean nothing. <code class=\"command\">" +
           html_escaped(ablate_command(results, " --timing")) +
           "</code> takes them, alone and uncached.</p>\n";
  }
  std::string text = speed_part(results, tables, scripted);
  if (scripted) {
    text +=
        "<figure id=\"figure-times\"><ul class=\"legend\"></ul><div class=\"plot\"></div>\n"
        "<figcaption>Mean wall time of each stage for a frame, of a pass with one job and "
        "nothing shared.</figcaption></figure>\n";
  }
  return text + to_html(times_sheet(results, tables));
}

std::string reproduce_part(const Results& results, const ReportTables& tables) {
  std::string text =
      "<p>A cell is one combination on one sequence with one seed. Its key stands for its "
      "settings, "
      "the builds of its components and its data; cells with the same key were run once.</p>\n"
      "<p>The whole plan again: <code class=\"command\">" +
      html_escaped(results.plan.command) + "</code></p>\n";
  if (!lists_every_cell(tables)) {
    text +=
        "<p class=\"notice\">The plan has many cells: below are those of the combinations with the "
        "smallest means or with failures. <code>report/cells.csv</code> has all.</p>\n";
  }
  for (std::size_t i = 0; i < tables.combinations.size(); ++i) {
    const Combination& combination = tables.combinations[i];
    if (!combination.detailed) continue;
    TextTable cells = cells_sheet(results, combination.cells);
    cells.note.clear();
    const PlanCell& first = results.plan.cells[combination.cells.front()];
    text += fmt::format("<details><summary>{}</summary><div id=\"{}\">\n{}",
                        html_escaped(combination.name), anchor_of(i),
                        failures_of(results, combination));
    text +=
        "<p>The first of its cells again; the others with their keys: <code "
        "class=\"command\">" +
        html_escaped(command_of(results, first)) + "</code></p>\n" + settings_of(results, first) +
        to_html(std::move(cells)) + "</div></details>\n";
  }
  return text;
}

}  // namespace weft::lab
