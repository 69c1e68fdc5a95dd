// SPDX-License-Identifier: Apache-2.0
#include "lab/report/runs/run_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <weft/core/base64.hpp>
#include <weft/core/shell_word.hpp>

namespace weft::lab {
namespace {

std::string short_part(const RunData& run) {
  std::string text = "<div class=\"verdict\">\n";
  for (const std::string& sentence : sentences_of(run)) {
    text += "<p>" + html_escaped(sentence) + "</p>\n";
  }
  return text + "</div>\n";
}

std::string place_for(const char* id, const char* caption) {
  return fmt::format(
      "<figure id=\"{}\"><ul class=\"legend\"></ul><div class=\"plot\"></div>\n"
      "<figcaption>{}</figcaption></figure>\n",
      id, caption);
}

bool has_error(const RunData& run) {
  return std::any_of(run.frames.begin(), run.frames.end(),
                     [](const RunFrame& frame) { return std::isfinite(frame.mean_mm); });
}

std::string frames_part(const RunData& run, bool scripted) {
  if (!scripted) return "";
  return place_for(
      "figure-run",
      has_error(run)
          ? "Mean 3D error of each frame, by the state of its shape. A click shows the "
            "nearest frame that the 3D view has. Frames without an error are at the foot."
          : "Confidence of each frame, by the state of its shape; the run has no truth. A "
            "click shows the nearest frame that the 3D view has.");
}

std::string times_part(const RunData& run, bool scripted) {
  const TextTable sheet = stages_sheet(run);
  if (sheet.rows.empty()) return "";
  return (scripted ? place_for("figure-run-times", "Wall-clock time of the stages of each frame.")
                   : "") +
         to_html(sheet);
}

bool has_truth(const RunData& run) {
  return std::any_of(run.view.frames.begin(), run.view.frames.end(),
                     [](const ViewFrame& frame) { return !frame.truth.empty(); });
}

/// ": 0.31 mm mean error", or how sure the frame is.
std::string what_of(const RunFrame& frame) {
  if (std::isfinite(frame.mean_mm)) {
    return ": " + number_cell(frame.mean_mm, 3).shown + " mm mean error";
  }
  return std::isfinite(frame.confidence) ? fmt::format(": confidence {:.2f}", frame.confidence)
                                         : "";
}

std::string worst_part(const RunData& run) {
  if (run.worst.empty()) return "";
  std::string text = has_error(run)
                         ? "<p>The frames with the largest errors."
                         : "<p>The frames that are least sure of themselves; the run has no truth.";
  text +=
      " Left the image of the video, if the run has one; beside it, from the camera, the estimate";
  text += has_truth(run) ? ", coloured by its error, and the truth.</p>\n<div class=\"worst\">\n"
                         : ".</p>\n<div class=\"worst without-truth\">\n";
  for (const WorstFrame& worst : run.worst) {
    const auto frame = std::find_if(run.frames.begin(), run.frames.end(),
                                    [&](const RunFrame& one) { return one.frame == worst.frame; });
    text += fmt::format("<figure data-frame=\"{}\">", worst.frame);
    if (!worst.jpeg.empty()) {
      text += "<img alt=\"\" src=\"data:image/jpeg;base64," + base64(worst.jpeg) + "\">\n";
    }
    text += fmt::format("<figcaption>Frame {}, {}{}</figcaption></figure>\n", worst.frame,
                        html_escaped(frame->state), what_of(*frame));
  }
  return text + "</div>\n";
}

std::string again_command(const RunData& run) {
  return "weft run " + shell_word(run.folder + "/pipeline.yaml") + " --out runs/again";
}

std::string settings_part(const RunData& run) {
  std::vector<std::pair<std::string, std::string>> facts;
  for (const auto& [name, value] :
       {std::pair{"pipeline", run.pipeline}, std::pair{"weft", run.version},
        std::pair{"git", run.git}, std::pair{"processor", run.processor}}) {
    if (!value.empty()) facts.emplace_back(name, value);
  }
  std::string text = facts_html(facts, again_command(run));
  if (run.settings.empty()) return text;
  return text + "<details><summary>Its effective settings</summary><pre>" +
         html_escaped(run.settings) + "</pre></details>\n";
}

}  // namespace

Page page_of(const RunData& run, bool scripted) {
  const TextTable reasons = reasons_sheet(run);
  const std::string viewer =
      run.view.frames.empty() || !scripted
          ? ""
          : viewer_html(fmt::format("The page holds {} frames of the run, the worst among them.",
                                    run.view.frames.size()),
                        has_truth(run));
  const std::string name = std::filesystem::path(run.folder).lexically_normal().filename().string();
  return {name.empty() ? run.metrics.run : name,
          "Report of a run, made by Weft " + run.version + ".",
          run.folder,
          {{"verdicts", "In short", short_part(run)},
           {"errors", "Frame by frame", frames_part(run, scripted)},
           {"reasons", "Why frames have no result or a weak one",
            reasons.rows.empty() ? "" : to_html(reasons)},
           {"print", "Against the flat print", flat_print_html(run.print, run.metrics)},
           {"worst", has_error(run) ? "Worst frames" : "Least certain frames", worst_part(run)},
           {"shapes", has_truth(run) ? "Estimate and truth in 3D" : "Shapes in 3D", viewer},
           {"times", "Times", times_part(run, scripted)},
           {"frames", "Every frame", to_html(frames_sheet(run))},
           {"reproduce", "Settings, and how to run it again", settings_part(run)}},
          scripted ? to_json(run) : ""};
}

}  // namespace weft::lab
