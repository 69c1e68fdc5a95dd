// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <weft/core/statistics.hpp>

#include "lab/report/runs/run_page.hpp"

namespace weft::lab {
namespace {

std::string shapes_text(const RunData& run) {
  const FrameCounts& counts = run.metrics.counts;
  std::string text =
      fmt::format("{} of {} frames were reconstructed", counts.solved(), counts.frames);
  if (counts.weak > 0) text += fmt::format(", {} of them weak", counts.weak);
  std::string others;
  const auto add = [&](std::int64_t count, const char* what, const std::string& which) {
    if (count == 0) return;
    others += fmt::format("{}{} {} {}{}", others.empty() ? "" : ", ", count,
                          count == 1 ? "has" : "have", what, which);
  };
  const auto in_state = [&](const char* state) {
    std::vector<std::uint64_t> frames;
    for (const RunFrame& frame : run.frames) {
      if (frame.state == state) frames.push_back(frame.frame);
    }
    return " (" + first_frames(frames) + ")";
  };
  add(counts.predicted, "a predicted shape", in_state("predicted"));
  add(counts.lost, "an old shape, as the object is lost", in_state("lost"));
  add(counts.none, "no shape", in_state("none"));
  add(counts.invalid, "a shape that is not finite", "");
  if (!others.empty()) text += "; " + others;
  return text + "." + (run.metrics.interrupted ? " The run did not come to its end." : "");
}

std::string error_text(const RunData& run) {
  const TruthMetrics& all = run.metrics.all;
  if (all.frames == 0) {
    return fmt::format(
        "The run has no truth, so its error is unknown; its lengths are wrong by {:.2g} %.",
        kPercent * run.metrics.strain_mean);
  }
  if (!std::isfinite(all.solved_error.mean_mm)) {
    return fmt::format("None of {} frames with truth has an error to measure.", all.frames);
  }
  std::string text = fmt::format(
      "The mean 3D error is {:.3g} mm over {} frames with truth; the worst, frame {}, is off by "
      "{:.3g} mm.",
      all.solved_error.mean_mm, all.solved_error.frames, all.solved_error.worst_frame,
      all.solved_error.worst_mm);
  if (all.failures() > 0) {
    text += fmt::format(" {} of {} frames with truth failed.", all.failures(), all.frames);
  }
  return text;
}

std::string flat_print_text(const RegistrationMetrics& registration) {
  std::string text = fmt::format(
      "Against the flat print, {:.1f} % of {} patches in {} frames are within 1 mm and {:.1f} % "
      "within 2 mm; the median displacement is {:.2f} mm.",
      registration.within_1mm_percent, registration.patches, registration.frames,
      registration.within_2mm_percent, registration.median_mm);
  if (registration.frames_unmeasured > 0) {
    text += fmt::format(" {} could not be compared.",
                        registration.frames_unmeasured == 1
                            ? "One frame"
                            : fmt::format("{} frames", registration.frames_unmeasured));
  }
  return text;
}

/// The stage that takes longest, by its median.
std::string time_text(const RunData& run) {
  std::vector<double> totals;
  for (const RunFrame& frame : run.frames) {
    double total = 0.0;
    for (const StageOutcome& stage : frame.stages) total += std::isfinite(stage.ms) ? stage.ms : 0;
    if (total > 0.0) totals.push_back(total);
  }
  std::string slowest;
  double longest_ms = 0.0;
  for (const TextRow& row : stages_sheet(run).rows) {
    const double median_ms = row.cells[1].exact.empty() ? 0.0 : std::stod(row.cells[1].exact);
    if (median_ms <= longest_ms) continue;
    longest_ms = median_ms;
    slowest = row.cells[0].shown;
  }
  if (totals.empty() || slowest.empty()) return "";
  return fmt::format("The stages of a frame take {:.3g} ms (median), {:.3g} of them {}.",
                     median(totals), longest_ms, slowest);
}

}  // namespace

std::vector<std::string> sentences_of(const RunData& run) {
  std::vector<std::string> sentences{shapes_text(run)};
  if (run.metrics.has_solver) sentences.push_back(error_text(run));
  if (run.metrics.registration.frames > 0) {
    sentences.push_back(flat_print_text(run.metrics.registration));
  }
  if (const std::string times = time_text(run); !times.empty()) sentences.push_back(times);
  std::set<std::string> printed;
  for (const RunFrame& frame : run.frames) {
    for (const std::string& warning : frame.warnings) {
      if (!printed.insert(warning).second) continue;
      sentences.push_back(fmt::format("At frame {}: {}", frame.frame, warning));
    }
  }
  for (const std::string& text : run.metrics.implements) {
    const bool is_reconstruction = text.ends_with(": reconstruction");
    if (!is_reconstruction) continue;
    sentences.push_back(fmt::format(
        "{} is a reconstruction: steps or constants that its reference does not give are the "
        "plugin author's.",
        text.substr(0, text.find(':'))));
  }
  for (const std::string& id : run.metrics.truth_users) {
    sentences.push_back(id + " may read the ground truth: these figures are no measurement.");
  }
  return sentences;
}

}  // namespace weft::lab
