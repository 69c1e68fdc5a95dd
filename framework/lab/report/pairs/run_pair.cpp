// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>
#include <map>
#include <weft/core/statistics.hpp>

#include "lab/report/drawing/line_chart.hpp"
#include "lab/report/pairs/pair_content.hpp"
#include "lab/report/pairs/settings.hpp"
#include "lab/report/runs/run_data.hpp"
#include "lab/report/tables/scene_effects.hpp"
#include "lab/statistics/sentence_parts.hpp"

namespace weft::lab {
namespace {

using ByFrame = std::map<std::uint64_t, double>;

ByFrame frame_errors_mm(const RunData& run) {
  ByFrame errors;
  for (const RunFrame& frame : run.frames) {
    if (std::isfinite(frame.mean_mm)) errors[frame.frame] = frame.mean_mm;
  }
  return errors;
}

ByFrame frame_times_ms(const RunData& run) {
  ByFrame times;
  for (const RunFrame& frame : run.frames) {
    double total_ms = 0.0;
    for (const StageOutcome& stage : frame.stages) {
      total_ms += std::isfinite(stage.ms) ? stage.ms : 0.0;
    }
    if (total_ms > 0.0) times[frame.frame] = total_ms;
  }
  return times;
}

/// Values of the frames that have one in both runs, in their order.
struct PairedFrames {
  std::vector<double> a, b, differences;
};

PairedFrames paired(const ByFrame& a, const ByFrame& b) {
  PairedFrames frames;
  for (const auto& [frame, value] : a) {
    const auto other = b.find(frame);
    if (other == b.end()) continue;
    frames.a.push_back(value);
    frames.b.push_back(other->second);
    frames.differences.push_back(value - other->second);
  }
  return frames;
}

SceneEffect effect_of(const std::vector<double>& frames) { return frame_effect("", {{1, frames}}); }

IntervalRow row_of(const std::string& name, const SceneEffect& effect, std::size_t frames,
                   ColourName colour) {
  return {name,
          interval_text(effect.mean, effect.interval) + fmt::format(", {} frames", frames),
          {{effect.mean, effect.interval, colour}}};
}

/// Both values on one scale, and their difference on another.
PanelFigure paired_figure(const std::string& name, const std::string& measure,
                          const std::string& unit, const PairedFrames& frames) {
  IntervalChart both{name, measure + " of both runs", "", measure + ", " + unit, {}, 300.0};
  both.rows = {row_of("A", effect_of(frames.a), frames.a.size(), "series-1"),
               row_of("B", effect_of(frames.b), frames.b.size(), "series-2")};
  IntervalChart difference = both;
  difference.axis = "A − B, " + unit;
  difference.rows = {
      row_of("A − B", effect_of(frames.differences), frames.differences.size(), "ink")};
  return {{draw(both, domain_of({both}, true)), draw(difference, domain_of({difference}, false))},
          "Mean over the frames that have a value in both runs, and the mean of their paired "
          "differences. The intervals are by a bootstrap over stretches of consecutive frames. "
          "They hold for these very frames, not for other sequences."};
}

/// "A is lower by 0.12 mm in mean 3D error (95 % interval 0.1 to 0.14): ..."
std::string paired_sentence(const std::string& measure, const std::string& unit,
                            const PairedFrames& frames) {
  const SceneEffect effect = effect_of(frames.differences);
  const Interval& interval = effect.interval;
  const std::string means = fmt::format("{} and {} over {} frames", with_unit(mean(frames.a), unit),
                                        with_unit(mean(frames.b), unit), frames.a.size());
  if (std::isnan(interval.low)) {
    return fmt::format("The {} is {}: too few frames for an interval.", measure, means);
  }
  if (interval.low <= 0.0 && interval.high >= 0.0) {
    return fmt::format(
        "A and B do not differ significantly in {}: {}; 95 % interval of the difference {} to {}.",
        measure, means, three_digits(interval.low), with_unit(interval.high, unit));
  }
  const bool a_is_lower = effect.mean < 0.0;
  return fmt::format("The {} of {} is lower by {}: {}; 95 % interval {} to {}.", measure,
                     a_is_lower ? "A" : "B", with_unit(std::abs(effect.mean), unit), means,
                     three_digits(a_is_lower ? -interval.high : interval.low),
                     with_unit(a_is_lower ? -interval.low : interval.high, unit));
}

LineSeries series_of(const std::string& name, const ByFrame& values, ColourName colour) {
  LineSeries series{name, colour, {}};
  for (const auto& [frame, value] : values) {
    series.points.push_back({static_cast<double>(frame), value});
  }
  return series;
}

TextTable stage_times_sheet(const RunData& a, const RunData& b) {
  TextTable table{"stage_times",
                  "Time of each stage",
                  "Medians over the frames in which the stage ran.",
                  {{"stage", "stage"},
                   {"A, ms", "a_ms", true},
                   {"B, ms", "b_ms", true},
                   {"A / B", "ratio", true}},
                  {}};
  const auto times_of = [](const RunData& run, std::vector<std::string>& order) {
    std::map<std::string, std::vector<double>> times;
    for (const RunFrame& frame : run.frames) {
      for (const StageOutcome& stage : frame.stages) {
        if (!stage.has_run()) continue;
        if (std::count(order.begin(), order.end(), stage.stage) == 0) order.push_back(stage.stage);
        times[stage.stage].push_back(stage.ms);
      }
    }
    return times;
  };
  std::vector<std::string> order;
  const auto in_a = times_of(a, order), in_b = times_of(b, order);
  const auto median_in = [](const auto& times, const std::string& stage) {
    const auto found = times.find(stage);
    return found == times.end() ? kUnknown : median(found->second);
  };
  for (const std::string& stage : order) {
    const double a_ms = median_in(in_a, stage), b_ms = median_in(in_b, stage);
    table.rows.push_back({{text_cell(stage), number_cell(a_ms, 2), number_cell(b_ms, 2),
                           number_cell(a_ms / b_ms, 2)}});
  }
  return table;
}

/// Why frames of equal numbers are not the same; empty if they are.
std::string other_frames(const RunData& a, const RunData& b) {
  if (have_same_source(a.settings, b.settings)) return "";
  return "The errors are not compared frame by frame, since the sources have different settings: "
         "frames of equal numbers may show different shapes. Run both pipelines on the same "
         "source.";
}

void compare_errors(const RunData& a, const RunData& b, PairContent& content) {
  const ByFrame in_a = frame_errors_mm(a), in_b = frame_errors_mm(b);
  if (in_a.empty() || in_b.empty()) {
    content.refusals.push_back(
        fmt::format("The errors are not compared: {} no frame with truth and a shape.",
                    in_a.empty() && in_b.empty() ? "both runs have"
                    : in_a.empty()               ? "A has"
                                                 : "B has"));
    return;
  }
  if (const std::string reason = other_frames(a, b); !reason.empty()) {
    content.refusals.push_back(reason);
    return;
  }
  const PairedFrames frames = paired(in_a, in_b);
  if (frames.a.empty()) {
    content.refusals.emplace_back("The errors are not compared: no frame has one in both runs.");
    return;
  }
  content.sentences.push_back(paired_sentence("mean 3D error", "mm", frames));
  content.figures.push_back(paired_figure("paired-errors", "mean 3D error", "mm", frames));
  const LineChart chart{"errors-by-frame",
                        "Mean 3D error of each frame",
                        "frame",
                        "mean 3D error, mm",
                        {series_of("A", in_a, "series-1"), series_of("B", in_b, "series-2")}};
  content.figures.push_back(
      {{draw(chart)}, "Mean 3D error of each frame with truth and a shape. Blue: A; orange: B."});
}

void compare_times(const RunData& a, const RunData& b, PairContent& content) {
  if (a.processor != b.processor) {
    content.refusals.push_back(fmt::format(
        "The times are not compared, since the processors differ: A ran on {}, B on {}.",
        a.processor.empty() ? "an unknown one" : a.processor,
        b.processor.empty() ? "an unknown one" : b.processor));
    return;
  }
  const PairedFrames frames = paired(frame_times_ms(a), frame_times_ms(b));
  if (frames.a.empty()) return;
  content.sentences.push_back(paired_sentence("time of a frame", "ms", frames));
  content.figures.push_back(paired_figure("paired-times", "time of a frame", "ms", frames));
  content.tables.push_back(stage_times_sheet(a, b));
}

}  // namespace

Result<PairContent> compare_runs(const std::string& a, const std::string& b) {
  const auto first = read_run_data(a), second = read_run_data(b);
  if (!first) return first.error();
  if (!second) return second.error();
  PairContent content;
  content.version = first->version;
  compare_errors(*first, *second, content);
  const FrameCounts &of_a = first->metrics.counts, &of_b = second->metrics.counts;
  content.sentences.push_back(fmt::format("A reconstructed {} of {} frames, B {} of {}.",
                                          of_a.solved(), of_a.frames, of_b.solved(), of_b.frames));
  compare_times(*first, *second, content);
  content.tables.insert(content.tables.begin(), settings_sheet(first->settings, second->settings));
  return content;
}

}  // namespace weft::lab
