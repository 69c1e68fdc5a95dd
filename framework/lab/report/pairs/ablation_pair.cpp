// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "lab/report/notes.hpp"
#include "lab/report/pairs/pair_content.hpp"
#include "lab/report/pairs/settings.hpp"
#include "lab/report/text/page.hpp"
#include "lab/statistics/sentence_parts.hpp"

namespace weft::lab {
namespace {

struct ReadAblation {
  Results results;
  ReportTables tables;
};

Result<ReadAblation> read_ablation(const std::string& folder) {
  auto results = read_results(folder);
  if (!results) return results.error();
  auto tables = make_tables(*results);
  if (!tables) return tables.error();
  return ReadAblation{*std::move(results), *std::move(tables)};
}

/// A combination of each, with the same values.
struct CommonCombination {
  const Combination *a, *b;
};

/// The names and values of the axes that have several values.
std::map<std::string, std::string> choice_of(const Results& results,
                                             const Combination& combination) {
  std::map<std::string, std::string> choice;
  for (std::size_t axis = 0; axis < results.plan.axes.size(); ++axis) {
    if (results.plan.axes[axis].values.size() < 2) continue;
    choice[results.plan.axes[axis].name] = combination.values[axis];
  }
  return choice;
}

std::vector<CommonCombination> common_combinations(const ReadAblation& a, const ReadAblation& b) {
  std::vector<CommonCombination> common;
  for (const Combination& one : a.tables.combinations) {
    const auto other = std::find_if(
        b.tables.combinations.begin(), b.tables.combinations.end(), [&](const Combination& each) {
          return choice_of(b.results, each) == choice_of(a.results, one);
        });
    if (other != b.tables.combinations.end()) common.push_back({&one, &*other});
  }
  return common;
}

void add_observations(const Results& results, const Combination& combination,
                      const std::string& treatment, std::vector<Observation>& observations) {
  for (const std::size_t index : combination.cells) {
    const PlanCell& cell = results.plan.cells[index];
    const CellRecord& record = results.record(cell);
    if (record.outcome == CellOutcome::missing) continue;
    for (const FrameError& error : record.errors) {
      observations.push_back({cell.sequence, error.frame, cell.seed, treatment, error.mean_mm});
    }
    if (record.errors.empty()) {
      observations.push_back({cell.sequence, kEveryFrame, cell.seed, treatment, kUnknown});
    }
  }
}

std::string axes_text(const Results& results) {
  std::string text;
  for (const PlanAxis& axis : results.plan.axes) {
    if (axis.values.size() > 1) text += (text.empty() ? "" : ", ") + axis.name;
  }
  return text.empty() ? "no axis" : text;
}

/// Why the errors of two ablations cannot be compared; empty if they can.
std::string obstacle(const ReadAblation& a, const ReadAblation& b,
                     const std::vector<CommonCombination>& common) {
  if (!a.tables.has_error || !b.tables.has_error) {
    return fmt::format("The errors are not compared: {} has no 3D error.",
                       a.tables.has_error ? "B" : "A");
  }
  if (a.results.alignment != b.results.alignment) {
    return fmt::format(
        "The errors are not compared, since they were measured with the alignments {} and {}.",
        a.results.alignment, b.results.alignment);
  }
  if (common.empty()) {
    return fmt::format(
        "The errors are not compared, since no combination is in both: A varies {}, B {}.",
        axes_text(a.results), axes_text(b.results));
  }
  const auto& names = a.results.plan.sequences;
  const bool shared = std::any_of(names.begin(), names.end(), [&](const std::string& name) {
    const auto& others = b.results.plan.sequences;
    return std::find(others.begin(), others.end(), name) != others.end();
  });
  return shared ? "" : "The errors are not compared, since no sequence is in both.";
}

TextTable pairs_sheet(const std::vector<CommonCombination>& common,
                      const std::vector<ComparisonTable>& tables) {
  TextTable table{"pairs",
                  "Combinations in both",
                  "Paired by sequence, frame and seed. All combinations are one family of tests.",
                  {{"combination", "combination"},
                   {"A, mm", "a_mm", true},
                   {"B, mm", "b_mm", true},
                   {"A − B, mm", "difference_mm", true},
                   {"95 % from", "low_mm", true},
                   {"to", "high_mm", true},
                   {"p, Holm", "p_holm", true},
                   {"n", "sequences", true},
                   {"A, ms a frame", "a_ms", true, "", true},
                   {"B, ms a frame", "b_ms", true, "", true}},
                  {}};
  for (std::size_t i = 0; i < common.size(); ++i) {
    if (tables[i].pairs.empty()) continue;
    const PairComparison& pair = tables[i].pairs.front();
    TextRow row{
        {text_cell(common[i].a->name), number_cell(pair.mean_a, 3), number_cell(pair.mean_b, 3),
         figure_cell(pair.test.mean), figure_cell(pair.interval.low),
         figure_cell(pair.interval.high), number_cell(pair.p_holm, 4), count_cell(pair.test.n),
         number_cell(common[i].a->processor_ms, 1), number_cell(common[i].b->processor_ms, 1)}};
    row.cells.front().tip = pair.sentence;
    table.rows.push_back(std::move(row));
  }
  return table;
}

PanelFigure differences_of(const std::vector<CommonCombination>& common,
                           const std::vector<ComparisonTable>& tables) {
  constexpr std::size_t kMostPairs = 16;
  IntervalChart chart{"differences", "Difference of each combination", "", "A − B, mm", {}, 400.0};
  for (std::size_t i = 0; i < common.size() && chart.rows.size() < kMostPairs; ++i) {
    if (tables[i].pairs.empty()) continue;
    const PairComparison& pair = tables[i].pairs.front();
    const ColourName colour = pair.call == Call::a   ? "series-1"
                              : pair.call == Call::b ? "series-2"
                                                     : "muted";
    chart.rows.push_back(
        {common[i].a->name,
         interval_text(pair.test.mean, pair.interval) + fmt::format(", n {}", pair.test.n),
         {{pair.test.mean, pair.interval, colour}}});
  }
  if (chart.rows.empty()) return {};
  return {{draw(chart, domain_of({chart}, false))},
          "Mean paired difference of the 3D error over n sequences. Less is better. Blue: A is; "
          "orange: B is; grey: not decided. The table has all combinations."};
}

/// The headline of each combination, or of many their number.
std::vector<std::string> sentences_of(const std::vector<ComparisonTable>& tables) {
  constexpr std::size_t kFew = 3;
  std::vector<std::string> headlines;
  std::size_t a_better = 0, b_better = 0;
  for (const ComparisonTable& table : tables) {
    if (table.pairs.empty()) continue;
    headlines.push_back(table.headline);
    a_better += table.pairs.front().verdict == Call::a ? 1 : 0;
    b_better += table.pairs.front().verdict == Call::b ? 1 : 0;
  }
  if (headlines.size() <= kFew) return headlines;
  return {fmt::format("A is better in {} of {} combinations, B in {}; the others are not decided.",
                      a_better, headlines.size(), b_better)};
}

Result<void> compare_errors(const ReadAblation& a, const ReadAblation& b,
                            const std::vector<CommonCombination>& common, PairContent& content) {
  std::vector<ObservationGroup> groups;
  for (const CommonCombination& each : common) {
    ObservationGroup group{common.size() > 1 ? "With " + each.a->name : "", {}};
    add_observations(a.results, *each.a, "A", group.observations);
    add_observations(b.results, *each.b, "B", group.observations);
    groups.push_back(std::move(group));
  }
  const auto tables = compare_separately(groups);
  if (!tables) return tables.error();
  content.sentences = sentences_of(*tables);
  content.figures.push_back(differences_of(common, *tables));
  content.tables.push_back(pairs_sheet(common, *tables));
  return {};
}

TextTable plans_sheet(const ReadAblation& a, const ReadAblation& b) {
  TextTable table{"plans", "Plans", "", {{"part", "part"}, {"A", "a"}, {"B", "b"}}, {}};
  std::map<std::string, std::string> in_b;
  for (const auto& [name, value] : facts_of(b.results, b.tables)) in_b[name] = value;
  const auto add = [&](const std::string& name, const std::string& left, const std::string& right) {
    if (left != right) table.rows.push_back({{text_cell(name), text_cell(left), text_cell(right)}});
  };
  add("weft", a.results.version, b.results.version);
  for (const auto& [name, value] : facts_of(a.results, a.tables)) {
    const auto other = in_b.extract(name);
    add(name, value, other.empty() ? "–" : other.mapped());
  }
  for (const auto& [name, value] : in_b) add(name, "–", value);
  return table;
}

std::string settings_of(const Results& results, const Combination& combination) {
  return text_of_file(results.folder + "/cells/" +
                      results.plan.cells[combination.cells.front()].key + "/pipeline.yaml");
}

}  // namespace

Result<PairContent> compare_ablations(const std::string& a, const std::string& b) {
  const auto first = read_ablation(a), second = read_ablation(b);
  if (!first) return first.error();
  if (!second) return second.error();
  PairContent content;
  content.version = first->results.version;
  const std::vector<CommonCombination> common = common_combinations(*first, *second);
  const std::string reason = obstacle(*first, *second, common);
  if (reason.empty()) {
    if (auto done = compare_errors(*first, *second, common, content); !done) return done.error();
  } else {
    content.refusals.push_back(reason);
  }
  content.tables.push_back(plans_sheet(*first, *second));
  if (!common.empty()) {
    content.tables.push_back(settings_sheet(settings_of(first->results, *common.front().a),
                                            settings_of(second->results, *common.front().b)));
    content.tables.back().note = "Of the first cell of " + common.front().a->name + ".";
  }
  return content;
}

}  // namespace weft::lab
