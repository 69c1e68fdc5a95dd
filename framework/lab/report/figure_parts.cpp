// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <weft/core/base64.hpp>

#include "lab/report/parts.hpp"
#include "lab/report/sheets.hpp"
#include "lab/report/text/page.hpp"
#include "lab/report/text/text_table.hpp"

namespace weft::lab {
namespace {

/// A place for a figure, with what a reader should know of it.
std::string figure(const std::string& id, const std::string& caption) {
  return fmt::format(
      "<figure id=\"{}\"><div class=\"plot\"></div>\n"
      "<figcaption>{}</figcaption></figure>\n",
      id, caption);
}

std::string sweep_figure(const Results& results, const Sweep& sweep, std::size_t index) {
  const std::string axis = html_escaped(results.plan.axes[sweep.axis].swept);
  const std::string title = sweep.stage.empty()
                                ? "Along " + axis
                                : "ROC of " + html_escaped(sweep.stage) + " over " + axis;
  const std::string caption =
      sweep.stage.empty()
          ? "Means over sequences, each the mean over its seeds; the band is the interval of the "
            "mean error in the table of results. Measures that do not change are omitted."
          : "A point is the mean over all frames at one value of " + axis +
                ", which changes what the stage rejects and not what it is given. AUC: trapezoids, "
                "with (0, 0) and (100, 100) added; in percent. "
                "Positive is a rejected match.";
  return fmt::format(
      "<figure class=\"sweep\" id=\"figure-sweep-{}\" data-sweep=\"{}\"><h3>{}</h3>\n<div "
      "class=\"controls\"></div><div class=\"plot\"></div>\n<figcaption>{}</figcaption></figure>\n",
      index, index, title, caption);
}

bool has_scores(const ReportTables& tables, const std::string& stage) {
  return std::any_of(tables.combinations.begin(), tables.combinations.end(),
                     [&](const Combination& combination) {
                       const FilterRates* rates = combination.filter(stage);
                       if (rates == nullptr) return false;
                       const ScoreShares shares = scores_of(*rates);
                       return !shares.mismatches.empty() || !shares.correct.empty();
                     });
}

}  // namespace

std::string curves_part(const ReportTables& tables, const Figures& figures) {
  if (!tables.has_error) return "";
  std::string text =
      "<p>The squares in the table of results select the combinations to plot, sixteen at most. If "
      "there are many, each has a separate panel, in which the others are grey; those with the "
      "same curve share one.</p>\n<h3>Distribution</h3>\n" +
      figure("figure-distribution",
             "Share of all frames with truth whose mean error is at most x. Frames without a "
             "reconstructed shape have no error: they keep a curve below 100 %.");
  const auto long_enough = [](const FrameCurve& curve) { return curve.error.x.size() > 1; };
  if (std::none_of(figures.over_frames.begin(), figures.over_frames.end(), long_enough)) {
    return text;
  }
  return text + "<h3>Over the frames</h3>\n" +
         figure(
             "figure-by-frame",
             fmt::format(
                 "Mean over sequences, each the mean over its seeds, of the error at each frame. "
                 "The difference is to the combination with the smallest mean, sequence by "
                 "sequence. The band is the 95 % interval by a bootstrap over sequences, from {} "
                 "on. Frames that were not solved are omitted: the table has their number.",
                 kLeastSequences));
}

std::string certainty_part(const Results& results, const ReportTables& tables, bool scripted) {
  const TextTable sheet = certainty_sheet(results, tables);
  if (sheet.rows.empty()) return "";
  // A single point is in the table already.
  const auto says_more = [](const Combination& combination) {
    const auto& bins = combination.certainty.bins;
    return std::count_if(bins.begin(), bins.end(),
                         [](const ConfidenceBin& bin) { return bin.frames > 0; }) > 1;
  };
  if (!scripted ||
      std::none_of(tables.combinations.begin(), tables.combinations.end(), says_more)) {
    return to_html(sheet);
  }
  return to_html(sheet) + "<h3>Reliability</h3>\n" +
         figure("figure-reliability",
                "Of the frames whose confidence is in a tenth of [0, 1], the share that is right, "
                "at their mean confidence; larger where there are more of them. On the diagonal a "
                "confidence equals the share that is right; above it, it is too low. Combinations "
                "whose frames are all in one tenth are not plotted.");
}

std::string sweeps_part(const Results& results, const Figures& figures) {
  std::string text;
  for (std::size_t i = 0; i < figures.sweeps.size(); ++i) {
    text += sweep_figure(results, figures.sweeps[i], i);
  }
  return text;
}

std::string scores_part(const ReportTables& tables) {
  std::string text;
  for (std::size_t i = 0; i < tables.filter_stages.size(); ++i) {
    if (!has_scores(tables, tables.filter_stages[i])) continue;
    text += fmt::format(
        "<figure class=\"scores\" id=\"figure-scores-{}\" data-scores=\"{}\"><h3>Scores of "
        "{}</h3>\n"
        "<div class=\"controls\"></div><div class=\"plot\"></div>\n"
        "<figcaption>Scores of the filter for its matches, 1 best. Curves: share of all "
        "mismatches, and of all inliers, in each fortieth of its scores.</figcaption></figure>\n",
        i, i, html_escaped(tables.filter_stages[i]));
  }
  return text;
}

std::string worst_part(const Results& results, const Figures& figures) {
  if (figures.worst_frames.empty()) return "";
  std::string text =
      "<p>The frames with the largest errors of each combination. Lines: the estimated mesh over "
      "the image, blue where its confidence is 1, yellow at 0.5 and orange at 0, fainter where it "
      "is only predicted. Blue dots: the matches that were kept. Beside it, from the camera, the "
      "estimate coloured by its error, and the truth. A click on a command copies it.</p>\n<div "
      "class=\"worst\">\n";
  for (std::size_t i = 0; i < figures.worst_frames.size(); ++i) {
    const ShownFrame& frame = figures.worst_frames[i];
    const PlanCell& cell = results.plan.cells[frame.cell];
    const TextCell error = number_cell(frame.mean_mm, 3);
    std::string values;
    for (const std::string& value : cell.values) values += html_escaped(value) + " · ";
    text += fmt::format(
        "<figure data-worst=\"{}\"><img alt=\"\" src=\"data:{};base64,{}\">\n<figcaption>{}{}, "
        "seed {}, frame {}: "
        "{}<br><code class=\"command\">{}</code></figcaption></figure>\n",
        i, frame.picture.type, base64(frame.picture.bytes), values, html_escaped(cell.sequence),
        cell.seed, frame.picture.frame,
        std::isfinite(frame.mean_mm) ? error.shown + " mm mean error"
                                     : "no error could be measured",
        html_escaped(command_of(results, cell)));
  }
  return text + "</div>\n";
}

std::string viewer_part(const Figures& figures) {
  if (figures.cells.empty()) return "";
  return viewer_html(
      fmt::format("The page contains the worst, the median and the best cell of each of the eight "
                  "combinations with the smallest mean errors. It has at most {} frames a cell and "
                  "{} true points a frame, evenly chosen.",
                  ViewLimits{}.frames, ViewLimits{}.truth_points),
      true);  // cells without an error are not shown
}

}  // namespace weft::lab
