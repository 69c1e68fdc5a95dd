// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <fstream>
#include <iterator>
#include <map>
#include <set>

#include "report_parts.hpp"
#include "report_sheets.hpp"

namespace weft::evaluation {
namespace {

std::string fact(const std::string& name, const std::string& value) {
  return "<dt>" + html_escaped(name) + "</dt><dd>" + value + "</dd>\n";
}

template <class T>
std::string listed(const std::vector<T>& values) {
  std::string text;
  for (const T& value : values) {
    text += text.empty() ? "" : ", ";
    if constexpr (std::is_same_v<T, std::string>) {
      text += html_escaped(value);
    } else {
      text += std::to_string(value);
    }
  }
  return text;
}

std::string data_use_text(const std::string& use) {
  if (use == "reporting") return "reporting: nothing was tuned on these sequences";
  if (use == "tuning") return "tuning: not for publication";
  return "the plan does not say";
}

struct Counts {
  std::int64_t done = 0, failed = 0, missing = 0;
};

Counts count_cells(const ReportTables& tables) {
  Counts counts;
  for (const Combination& combination : tables.combinations) {
    counts.done += combination.done;
    counts.failed += combination.failed;
    counts.missing += combination.missing;
  }
  return counts;
}

std::size_t distinct_keys(const Results& results) {
  std::set<std::string> keys;
  for (const PlanCell& cell : results.cells) keys.insert(cell.key);
  return keys.size();
}

std::string notice(const std::string& text) { return "<p class=\"notice\">" + text + "</p>\n"; }

/// What restrains everything that the page says.
std::string notices(const Results& results, const ReportTables& tables) {
  std::string text;
  const Counts counts = count_cells(tables);
  if (counts.missing > 0) {
    text += notice(fmt::format("{} cells have not been run yet: the figures are of what is there.",
                               counts.missing));
  }
  if (results.data_use == "tuning") {
    text += notice(
        "The sequences of this plan are for tuning: its figures are not for "
        "publication.");
  }
  if (results.accept_rebuilt) {
    text += notice(
        "Results of components that were built again are mixed here "
        "(<code>--accept-rebuilt</code>).");
  }
  for (const Combination& combination : tables.combinations) {
    if (!combination.uses_truth) continue;
    text += notice(
        "Some combinations have a component that may read the truth: they are no "
        "measurement, and their rows say so.");
    break;
  }
  return text;
}

/// The failed cells of a combination, each with its reason.
std::string failures_of(const Results& results, const Combination& combination) {
  std::map<std::string, std::int64_t> reasons;
  for (const std::size_t index : combination.cells) {
    const CellRecord& record = results.record(results.cells[index]);
    if (record.outcome == CellOutcome::failed) ++reasons[record.reason];
  }
  std::string text;
  for (const auto& [reason, count] : reasons) {
    text += fmt::format("<p class=\"failures\">{} failed: {}</p>\n", count, html_escaped(reason));
  }
  return text;
}

/// What may be said of each pair and of all together.
std::string sentences_of(const ComparisonTable& table) {
  std::string text = "<ul class=\"small\">\n";
  if (table.friedman) text += "<li>" + html_escaped(table.friedman->sentence) + "</li>\n";
  for (const PairComparison& pair : table.pairs) {
    text += "<li>" + html_escaped(pair.sentence) + "</li>\n";
  }
  return text + "</ul>\n";
}

/// The effective settings of a cell, where its folder has them.
std::string settings_of(const Results& results, const PlanCell& cell) {
  std::ifstream stream(results.folder + "/cells/" + cell.key + "/pipeline.yaml", std::ios::binary);
  if (!stream) return "";
  const std::string settings{std::istreambuf_iterator<char>(stream), {}};
  return "<details><summary>Its effective settings</summary><pre>" + html_escaped(settings) +
         "</pre></details>\n";
}

}  // namespace

std::string verdicts_part(const Results& results, const ReportTables& tables) {
  std::string text = notices(results, tables);
  std::string verdicts;
  for (const ComparisonResult& comparison : tables.comparisons) {
    if (comparison.table.headline.empty()) continue;
    verdicts += "<li>" + html_escaped(comparison.table.headline) + "</li>\n";
  }
  if (verdicts.empty()) {
    return text + "<p>The plan names no comparison, so the page names no difference.</p>\n";
  }
  return text + "<ul class=\"verdicts\">\n" + verdicts + "</ul>\n";
}

std::string compared_part(const Results& results, const ReportTables& tables) {
  const Counts counts = count_cells(tables);
  std::string text = "<dl class=\"facts\">\n";
  for (const PlanAxis& axis : results.axes) text += fact(axis.name, listed(axis.values));
  text += fact(fmt::format("{} sequences", results.sequences.size()), listed(results.sequences));
  text += fact(fmt::format("{} seeds", results.seeds.size()), listed(results.seeds));
  text += fact("data for", data_use_text(results.data_use));
  text += fact("cells", fmt::format("{} planned: {} done, {} failed, {} not run; {} distinct",
                                    results.cells.size(), counts.done, counts.failed,
                                    counts.missing, distinct_keys(results)));
  const std::vector<std::string> processors(results.processors.begin(), results.processors.end());
  if (!processors.empty()) text += fact("processor", listed(processors));
  text += fact("command", "<code class=\"command\">" + html_escaped(results.command) + "</code>");
  return text + "</dl>\n";
}

std::string results_part(const Results& results, const ReportTables& tables) {
  std::string text = to_html(combinations_sheet(results, tables));
  text += "<p class=\"small muted\">";
  if (tables.has_error) {
    text +=
        "Mean: over the n sequences, each the mean over its seeds, of the mean 3D error of the "
        "solved frames; a frame's error is the mean distance of its true points from their places "
        "on the estimated mesh, without any alignment. The interval is a bootstrap over sequences. "
        "Worst: the largest mean error of a frame. ";
  }
  return text +
         "Frames failed: with truth, but without a shape, or off by more than a tenth of the "
         "template's diagonal; a cell that failed as a whole failed at each of them. Neither "
         "enters "
         "a mean. A row's first "
         "value leads to the keys and commands behind it.</p>\n";
}

std::string comparisons_part(const ReportTables& tables, bool scripted) {
  std::string text;
  for (std::size_t i = 0; i < tables.comparisons.size(); ++i) {
    const ComparisonResult& comparison = tables.comparisons[i];
    if (comparison.table.pairs.empty()) continue;
    text += fmt::format("<h3>{}: {}</h3>\n", html_escaped(comparison.plan.axis),
                        html_escaped(comparison.plan.metric));
    if (scripted) {
      text += fmt::format(
          "<figure class=\"differences\" id=\"figure-differences-{}\" data-comparison=\"{}\"><div "
          "class=\"plot\"></div>\n<figcaption>Mean difference with its 95 % interval. Grey: not "
          "decided.</figcaption></figure>\n",
          i, i);
    }
    text += to_html(comparison_sheet({comparison})) + sentences_of(comparison.table);
  }
  if (text.empty()) return text;
  return "<p>Paired by sequence, frame and seed; a sequence is the unit. An interval across zero, "
         "or "
         "a corrected p above 5 %, decides nothing.</p>\n" +
         text;
}

std::string expectations_part(const Results& results, const ReportTables& tables) {
  if (tables.expectations.empty()) return "";
  return to_html(expectations_sheet(results, tables)) +
         "<p class=\"small muted\">Measured: the mean over the cells that are selected. One "
         "without "
         "the figure misses the expectation too.</p>\n";
}

std::string filters_part(const Results& results, const ReportTables& tables) {
  if (tables.filter_stages.empty()) return "";
  return to_html(filters_sheet(results, tables)) +
         "<p class=\"small muted\">TPR: mismatches that were rejected; FPR: correct matches that "
         "were rejected; kept (n_s): of those that entered; precision (AoS): correct, of those "
         "kept. Each is the mean over the frames in which it is defined, then over seeds, then "
         "over "
         "the n sequences.</p>\n";
}

std::string times_part(const Results& results, const ReportTables& tables, bool scripted) {
  if (!tables.has_times) {
    return "<p>No times: the stages of these runs were shared and cached between cells, so that "
           "their times would mean nothing. <code class=\"command\">" +
           html_escaped(results.command) + " --timing</code> takes them, alone and uncached.</p>\n";
  }
  std::string text;
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
      html_escaped(results.command) + "</code></p>\n";
  for (std::size_t i = 0; i < tables.combinations.size(); ++i) {
    const Combination& combination = tables.combinations[i];
    const PlanCell& first = results.cells[combination.cells.front()];
    text += fmt::format("<details><summary>{}</summary><div id=\"{}\">\n{}",
                        html_escaped(combination.name), anchor_of(i),
                        failures_of(results, combination));
    text +=
        "<p>The first of its cells again; the others with their keys: <code "
        "class=\"command\">" +
        html_escaped(command_of(results, first)) + "</code></p>\n" + settings_of(results, first) +
        to_html(cells_sheet(results, combination.cells)) + "</div></details>\n";
  }
  return text;
}

}  // namespace weft::evaluation
