// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>
#include <fmt/format.h>

#include <cmath>
#include <memory>

#include "cli/data/data_commands.hpp"
#include "cli/ending/interruption.hpp"
#include "cli/output/json_text.hpp"
#include "cli/standard_components.hpp"
#include "pipeline/survey/data_survey.hpp"

namespace weft::cli {
namespace {

using nlohmann::ordered_json;

ordered_json truth_json(const std::string& kind, const TruthSurvey& truth) {
  const bool measured = std::isfinite(truth.nearest_m);
  return {{"kind", kind},
          {"frames", truth.frames},
          {"excluded", truth.excluded},
          {"fewest_points", truth.fewest_points},
          {"most_points", truth.most_points},
          {"points", truth.points},
          {"points_outside_image", truth.points_outside},
          {"points_behind_camera", truth.points_behind},
          {"nearest_m", measured ? ordered_json(truth.nearest_m) : ordered_json()},
          {"furthest_m", measured ? ordered_json(truth.furthest_m) : ordered_json()},
          {"largest_side_m",
           truth.largest_side_m > 0.0 ? ordered_json(truth.largest_side_m) : ordered_json()},
          {"depth_percent", truth.depth_percent},
          {"frames_with", truth.has}};
}

ordered_json camera_json(const DataSurvey& survey) {
  const Camera& camera = survey.camera;
  ordered_json json{{"fx", camera.fx},
                    {"fy", camera.fy},
                    {"cx", camera.cx},
                    {"cy", camera.cy},
                    {"width_px", camera.width_px},
                    {"height_px", camera.height_px}};
  if (survey.assumed) {
    json["assumed"] = {{"focal_sd_px", survey.assumed->focal_sd_px},
                       {"centre_sd_px", {survey.assumed->cx_sd_px, survey.assumed->cy_sd_px}},
                       {"from", survey.assumed->from}};
  }
  return json;
}

ordered_json survey_json(const std::string& path, const DataSurvey& survey) {
  ordered_json truth = ordered_json::array();
  for (const auto& [kind, each] : survey.truth) truth.push_back(truth_json(kind, each));
  return {{"path", path},
          {"kind", survey.kind},
          {"source", survey.source},
          {"frames", survey.frames},
          {"frames_grey", survey.grey},
          {"frames_colour", survey.colour},
          {"matches", survey.matches},
          {"first_stem", survey.first_stem},
          {"last_stem", survey.last_stem},
          {"first_s", survey.first_s},
          {"last_s", survey.last_s},
          {"camera", camera_json(survey)},
          {"frames_with_truth", survey.frames_with_truth},
          {"truth", std::move(truth)},
          {"failures", survey.failures},
          {"findings", survey.findings}};
}

void print_truth(const std::string& kind, const TruthSurvey& truth) {
  std::string points = std::to_string(truth.fewest_points);
  if (truth.most_points > truth.fewest_points) points += fmt::format(" to {}", truth.most_points);
  fmt::print("truth     {}: {} frames, {} points", kind.empty() ? "(no kind)" : kind, truth.frames,
             points);
  if (std::isfinite(truth.nearest_m)) {
    fmt::print(", {:.3f} to {:.3f} m away", truth.nearest_m, truth.furthest_m);
  }
  if (truth.excluded > 0) fmt::print(", {} excluded", truth.excluded);
  for (const auto& [name, frames] : truth.has) {
    if (frames > 0) fmt::print(", {}", name);
  }
  if (truth.depth_percent > 0.0) fmt::print(" ({:.1f} % of the pixels)", truth.depth_percent);
  fmt::print("\n");
}

void print_survey(const std::string& path, const DataSurvey& survey) {
  const Camera& camera = survey.camera;
  fmt::print("{}: {}, read by {}\n", path, survey.kind, survey.source);
  fmt::print("frames    {}", survey.frames);
  if (!survey.first_stem.empty()) fmt::print(", {} to {}", survey.first_stem, survey.last_stem);
  if (survey.last_s > survey.first_s) {
    fmt::print(", {:.2f} s", survey.last_s - survey.first_s);
  }
  if (survey.grey + survey.colour == 0) fmt::print(", no images");
  if (survey.matches > 0) fmt::print(", {} matches", survey.matches);
  fmt::print("\ncamera    {} x {} px, fx {:.2f} fy {:.2f} cx {:.2f} cy {:.2f}, {}\n",
             camera.width_px, camera.height_px, camera.fx, camera.fy, camera.cx, camera.cy,
             survey.assumed ? "assumed" : "undistorted");
  for (const auto& [kind, truth] : survey.truth) print_truth(kind, truth);
  for (const std::string& finding : survey.findings) fmt::print("note      {}\n", finding);
  for (const std::string& failure : survey.failures) fmt::print("damaged   {}\n", failure);
  if (survey.failures.empty()) fmt::print("all frames can be read\n");
}

void inform(const std::string& path, const std::string& camera, bool json, Context& context) {
  const auto layout = find_data_layout(path, standard_sources(), camera);
  if (!layout) {
    print_error(layout.error());
    context.exit_code = kInputOutput;
    return;
  }
  const std::atomic<bool>& interrupted = watch_for_interruption();
  now_running("the survey of " + path);
  const auto survey = survey_data(*layout, context.registry(), interrupted);
  if (!survey) {
    print_error(survey.error());
    context.exit_code = kInputOutput;
    return;
  }
  if (json) {
    print_json(survey_json(path, *survey));
  } else {
    print_survey(path, *survey);
  }
  if (!survey->failures.empty()) context.exit_code = kFramesFailed;
}

}  // namespace

void add_data_info(CLI::App& data, Context& context) {
  struct Options {
    std::string path, camera;
    bool json = false;
  };
  const auto options = std::make_shared<Options>();
  CLI::App* command = data.add_subcommand(
      "info", "Read all frames of a sequence, a folder of images or a video, and print a summary");
  command->add_option("PATH", options->path, "Folder, video, or YAML file with a source")
      ->required();
  command->add_option("--camera", options->camera,
                      "Camera file, where none lies beside the images; auto: none, it is assumed");
  command->add_flag("--json", options->json, "Print JSON");
  command->callback(
      [&context, options] { inform(options->path, options->camera, options->json, context); });
}

}  // namespace weft::cli
