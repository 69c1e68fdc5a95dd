// SPDX-License-Identifier: Apache-2.0
#include "lab/report/panel_figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <weft/core/shell_word.hpp>

#include "lab/metrics/forms/catalogue.hpp"
#include "lab/metrics/forms/metric_path.hpp"
#include "lab/report/text/text_table.hpp"
#include "lab/statistics/sentence_parts.hpp"

namespace weft::lab {
namespace {

constexpr std::size_t kMostRanked = 16;  // rows of a ranking
constexpr std::size_t kMostPanels = 16;  // panels of a figure
constexpr double kPanelPx = 300.0;
constexpr std::size_t kColumns = 2;  // columns of a file, which has the width of a page

constexpr ColourName kBest = "series-1", kOther = "series-2", kWorse = "muted";

/// "ranking-filter": letters, digits and hyphens, as files and anchors accept them.
std::string figure_name(const std::string& kind, const std::string& about) {
  std::string name = kind + "-" + about;
  std::replace_if(
      name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) == 0; }, '-');
  return name;
}

/// Different for each comparison of a plan.
std::string figure_name(const std::string& kind, const PlanComparison& plan) {
  return figure_name(kind, plan.axis + (plan.metric == kErrorMetric ? "" : "-" + plan.metric) +
                               (plan.reference.empty() ? "" : "-" + plan.reference));
}

std::string axis_title(const std::string& measure, const std::string& unit) {
  return measure + (unit.empty() ? "" : ", " + unit);
}

std::string remark_of(const TreatmentSummary& treatment) {
  if (!std::isfinite(treatment.mean)) {
    return fmt::format("no value in {} results", treatment.rows);
  }
  std::string text = interval_text(treatment.mean, treatment.interval) +
                     fmt::format(", n {}", treatment.sequences);
  if (treatment.failures > 0) {
    text += fmt::format(", {} of {} failed", treatment.failures, treatment.rows);
  }
  return text;
}

/// True if the table calls `best` better than the other.
bool is_shown_better(const ComparisonTable& table, const std::string& best,
                     const std::string& other) {
  return std::any_of(table.pairs.begin(), table.pairs.end(), [&](const PairComparison& pair) {
    return (pair.a == best && pair.b == other && pair.verdict == Call::a) ||
           (pair.b == best && pair.a == other && pair.verdict == Call::b);
  });
}

IntervalChart ranking_chart(const ComparisonTable& table, const PlanComparison& plan,
                            const std::string& unit) {
  IntervalChart chart;
  chart.axis = axis_title(metric_name(plan.metric), unit);
  const auto treatments = ranked(table, better_of(plan.metric));
  for (const TreatmentSummary& each : treatments) {
    if (chart.rows.size() == kMostRanked) break;
    const std::string& best = treatments.front().name;
    const bool is_best = each.name == best;
    const bool worse = !is_best && is_shown_better(table, best, each.name);
    chart.rows.push_back(
        {each.name,
         remark_of(each),
         {{each.mean, each.interval, worse ? kWorse : kBest, !is_best && !worse}}});
  }
  return chart;
}

std::vector<Drawing> draw_all(const std::vector<IntervalChart>& charts, bool from_zero) {
  const Domain domain = domain_of(charts, from_zero);
  std::vector<Drawing> panels;
  for (const IntervalChart& chart : charts) panels.push_back(draw(chart, domain));
  return panels;
}

std::string more_text(std::size_t all, const char* things) {
  return all > kMostRanked ? fmt::format(" {} more {} are in the table.", all - kMostRanked, things)
                           : std::string();
}

/// Blue where A is better, orange where B is, grey where that is not decided.
ColourName colour_of(const Interval& interval, Better better) {
  const bool decided = std::isfinite(interval.low) && (interval.low > 0.0 || interval.high < 0.0);
  if (!decided) return kWorse;
  return (interval.high < 0.0) == (better == Better::lower) ? kBest : kOther;
}

}  // namespace

std::vector<TreatmentSummary> ranked(const ComparisonTable& table, Better better) {
  std::vector<TreatmentSummary> treatments = table.treatments;
  const double sign = better == Better::lower ? 1.0 : -1.0;
  std::stable_sort(treatments.begin(), treatments.end(), [&](const auto& a, const auto& b) {
    if (std::isnan(a.mean) || std::isnan(b.mean)) return !std::isnan(a.mean) && std::isnan(b.mean);
    return sign * a.mean < sign * b.mean;
  });
  return treatments;
}

std::string interval_text(double value, const Interval& interval) {
  if (!std::isfinite(value)) return "no value";
  if (!std::isfinite(interval.low)) return three_digits(value);
  return fmt::format("{} [{}, {}]", three_digits(value), three_digits(interval.low),
                     three_digits(interval.high));
}

Drawing PanelFigure::drawing() const { return in_a_grid(panels, kColumns); }

PanelFigure ranking_figure(const ComparisonResult& comparison) {
  if (comparison.table.treatments.empty()) return {};
  const PlanComparison& plan = comparison.plan;
  IntervalChart chart = ranking_chart(comparison.table, plan, comparison.unit);
  chart.name = figure_name("ranking", plan);
  chart.title = fmt::format("{} of each {}, the best first", metric_name(plan.metric), plan.axis);
  return {draw_all({chart}, true),
          "Mean over n sequences with its 95 % interval, the best first. Filled blue: the best. "
          "Hollow: not shown to be worse than the best. Grey: shown to be worse, or without a "
          "value. Differences are decided pair by pair, not by the overlap of these intervals." +
              more_text(comparison.table.treatments.size(), "values")};
}

PanelFigure ranking_figure(const Results& results, const ReportTables& tables) {
  struct Ranked {
    const Combination* combination;
    double value;
    Interval interval;
  };
  std::string metric = kErrorMetric;
  std::vector<Ranked> ranking;
  for (const Combination& each : tables.combinations) {
    if (std::isfinite(each.mean_mm)) ranking.push_back({&each, each.mean_mm, each.interval_mm});
  }
  for (std::size_t m = 0; m < results.plan.show.size() && ranking.empty(); ++m) {
    metric = results.plan.show[m];
    for (const Combination& each : tables.combinations) {
      if (std::isfinite(each.shown[m])) ranking.push_back({&each, each.shown[m], {}});
    }
  }
  if (ranking.empty()) return {};
  const double sign = better_of(metric) == Better::lower ? 1.0 : -1.0;
  std::stable_sort(ranking.begin(), ranking.end(), [&](const Ranked& a, const Ranked& b) {
    return sign * a.value < sign * b.value;
  });
  IntervalChart chart;
  chart.name = figure_name("ranking", "combinations");
  chart.title = metric_name(metric) + " of each combination, the best first";
  chart.axis = axis_title(metric_name(metric), unit_of(metric));
  for (const Ranked& each : ranking) {
    if (chart.rows.size() == kMostRanked) break;
    chart.rows.push_back({each.combination->name,
                          interval_text(each.value, each.interval) +
                              fmt::format(", n {}", each.combination->sequences),
                          {{each.value, each.interval}}});
  }
  return {draw_all({chart}, true),
          "Mean over n sequences, with its 95 % interval from six sequences on, the best first." +
              more_text(ranking.size(), "combinations")};
}

PanelFigure conditions_figure(const ComparisonResult& comparison, const SeparateComparison& axis) {
  std::vector<IntervalChart> charts;
  for (std::size_t i = 0; i < axis.tables.size(); ++i) {
    if (axis.tables[i].treatments.empty()) continue;
    IntervalChart chart = ranking_chart(axis.tables[i], comparison.plan, comparison.unit);
    chart.name = figure_name("conditions", comparison.plan) + "-" + figure_name("by", axis.axis);
    chart.title = fmt::format("{} of each {} by {}", metric_name(comparison.plan.metric),
                              comparison.plan.axis, axis.axis);
    chart.head = axis.axis + " " + axis.values[i];
    chart.width_px = kPanelPx;
    charts.push_back(std::move(chart));
  }
  if (charts.empty()) return {};
  return {draw_all(charts, true),
          "The same ranking with one value of " + axis.axis +
              " at a time, over one scale. All panels are one family of tests."};
}

PanelFigure differences_figure(const ComparisonResult& comparison) {
  const auto& pairs = comparison.table.pairs;
  if (pairs.empty()) return {};
  const Better better = better_of(comparison.plan.metric);
  IntervalChart chart;
  chart.name = figure_name("differences", comparison.plan);
  chart.title = "Difference of each pair of " + comparison.plan.axis;
  chart.axis = axis_title("Difference", difference_unit(comparison.unit));
  for (const PairComparison& pair : pairs) {
    if (chart.rows.size() == kMostRanked) break;
    chart.rows.push_back(
        {pair.a + " − " + pair.b,
         interval_text(pair.test.mean, pair.interval) + fmt::format(", n {}", pair.test.n),
         {{pair.test.mean, pair.interval, colour_of(pair.interval, better)}}});
  }
  return {draw_all({chart}, false),
          fmt::format("Mean paired difference A − B over n sequences, with its corrected interval "
                      "from {} sequences on. {} is better. Blue: A is; orange: B is; grey: not "
                      "decided.{}",
                      kLeastSequences, better == Better::lower ? "Less" : "More",
                      more_text(pairs.size(), "pairs"))};
}

PanelFigure scenes_figure(const ComparisonResult& comparison) {
  const Better better = better_of(comparison.plan.metric);
  std::vector<IntervalChart> charts;
  std::size_t most = 0;
  for (std::size_t i = 0; i < comparison.scenes.size() && charts.size() < kMostPanels; ++i) {
    if (comparison.scenes[i].empty()) continue;
    const PairComparison& pair = comparison.table.pairs[i];
    IntervalChart chart;
    chart.name = figure_name("scenes", comparison.plan);
    chart.title = "Difference of each pair of " + comparison.plan.axis + " by sequence";
    chart.head = pair.a + " − " + pair.b;
    chart.axis = axis_title("Difference", difference_unit(comparison.unit));
    chart.width_px = kPanelPx;
    for (const SceneEffect& effect : comparison.scenes[i]) {
      chart.rows.push_back({effect.scene,
                            interval_text(effect.mean, effect.interval),
                            {{effect.mean, effect.interval, colour_of(effect.interval, better)}}});
    }
    most = std::max(most, chart.rows.size());
    charts.push_back(std::move(chart));
  }
  if (most < 2) return {};
  return {draw_all(charts, false),
          "The same difference on each sequence, or kind of data where there are many. The "
          "interval of a sequence is by a bootstrap over stretches of its frames. It holds for "
          "this very sequence, not for others like it, and is not corrected for the number of "
          "rows."};
}

PanelFigure rates_figure(const ReportTables& tables, const std::string& stage) {
  IntervalChart chart;
  chart.name = figure_name("rates", stage);
  chart.title = "Mismatches rejected and precision of " + stage;
  chart.axis = "mismatches rejected and precision, %";
  std::size_t all = 0;
  for (const Combination& each : tables.combinations) {
    const FilterRates* rates = each.filter(stage);
    if (rates == nullptr || ++all > kMostRanked) continue;
    chart.rows.push_back(
        {each.name,
         fmt::format("{}, {} of {} matches", number_cell(rates->tpr_percent, 1).shown,
                     number_cell(rates->precision_percent, 1).shown, rates->entered),
         {{rates->tpr_percent, {}, kBest}, {rates->precision_percent, {}, kOther}}});
  }
  if (chart.rows.empty()) return {};
  return {draw_all({chart}, true), "Blue: mismatches that " + stage +
                                       " rejected; orange: precision, in percent." +
                                       more_text(all, "combinations")};
}

std::vector<PanelFigure> panel_figures(const Results& results, const ReportTables& tables) {
  std::vector<PanelFigure> figures{ranking_figure(results, tables)};
  for (const ComparisonResult& comparison : tables.comparisons) {
    figures.push_back(ranking_figure(comparison));
    for (const SeparateComparison& axis : comparison.separate) {
      figures.push_back(conditions_figure(comparison, axis));
    }
    figures.push_back(differences_figure(comparison));
    figures.push_back(scenes_figure(comparison));
  }
  for (const std::string& stage : tables.filter_stages) {
    figures.push_back(rates_figure(tables, stage));
  }
  std::erase_if(figures, [](const PanelFigure& figure) { return figure.panels.empty(); });
  return figures;
}

std::string paper_note(const std::string& folder) {
  return "<code class=\"command\">" +
         html_escaped("weft report " + shell_word(folder) + " --paper") + "</code> writes";
}

std::string to_html(const PanelFigure& figure, const std::string& note) {
  if (figure.panels.empty()) return "";
  std::string panels;
  for (const Drawing& panel : figure.panels) panels += to_svg_element(panel);
  return fmt::format(
      "<figure id=\"figure-{0}\"><div class=\"panels\">\n{1}</div>\n<figcaption>{2} "
      "<span class=\"files\">As SVG, PDF and PGF: {3} {0}.*</span></figcaption></figure>\n",
      figure.name(), panels, html_escaped(figure.caption), note);
}

}  // namespace weft::lab
