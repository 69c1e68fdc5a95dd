// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "cli/commands.hpp"
#include "cli/ending/interruption.hpp"
#include "cli/output/program_root.hpp"
#include "cli/run/browser.hpp"
#include "cli/run/run_settings.hpp"
#include "cli/run/running.hpp"
#include "pipeline/steering/settings_list.hpp"

namespace weft::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSink = "sinks/live";
constexpr const char* kVideo = "sources/video";

struct LiveOptions {
  RunArguments run;
  std::string video;
  bool demo = false, keep = false, record = false, no_browser = false;
};

/// Merged into every pipeline: the page, the newest frame only, and what keeps the frames.
Patch live_patch(bool records) {
  std::string text = std::string("realtime: latest\nsinks:\n  - {use: ") + kSink +
                     ", as: live, params: {camera_file: camera.yaml}}\n";
  if (records) {
    text +=
        "  - {use: sinks/dataset, as: recording, params: {path: recording, dense_truth: false}}\n";
  }
  auto parsed = yaml::parse(text, "weft live");
  return {{{"", "", true, "weft live", true}}, std::move(parsed->root)};
}

/// Plays a film instead of the pipeline's source; the camera file stays if the source already takes
/// films and cameras.
Patch video_patch(const std::string& video) {
  yaml::Node source, params, root;
  source.kind = params.kind = root.kind = yaml::Kind::map;
  params.entries.push_back({"path", {}, yaml::text_node(fs::absolute(video).string())});
  params.entries.push_back({"device", {}, yaml::plain_node("-1")});
  params.entries.push_back({"address", {}, yaml::text_node("")});
  source.entries.push_back({"use", {}, yaml::text_node(kVideo)});
  source.entries.push_back({"params", {}, std::move(params)});
  root.entries.push_back({"source", {}, std::move(source)});
  return {{{video, "", true, "--video", true}}, std::move(root)};
}

/// A value of a parameter as text, or nothing.
std::optional<std::string> value_of(const StageConfig& stage, const std::string& parameter) {
  const yaml::Node* params = stage.component.effective.find("params");
  const yaml::Node* value = params != nullptr ? params->find(parameter) : nullptr;
  if (value == nullptr || value->scalar.empty()) return std::nullopt;
  return value->scalar;
}

/// The address that the user opens.
struct Page {
  std::string address;  ///< without the token
  std::string token;    ///< empty where none is needed
};

/// The first word of a file that the sink has checked.
std::string word_in(const std::string& file) {
  std::ifstream in(file);
  std::string word;
  in >> word;
  return word;
}

/// Where the page is; nothing where no sink shows one, or at a port that is not known.
std::optional<Page> page_of(const PipelineConfig& config) {
  for (const StageConfig& sink : config.sinks) {
    if (sink.component.component().id != kSink) continue;
    const std::string address = value_of(sink, "address").value_or("");
    if (address.ends_with(":0")) return std::nullopt;
    const auto file = value_of(sink, "token_file");
    return Page{"http://" + address + "/",
                file ? word_in(*file) : value_of(sink, "token").value_or("")};
  }
  return std::nullopt;
}

/// The lines about the page. The token stays out of them, since they may end up in a log.
std::string words_on(const Page& page) {
  if (page.token.empty()) return page.address + "\n";
  return page.address + "?token=...\nReplace the dots by the token.\n";
}

/// Advice on what the user must do for this source.
std::string advice_for(const PipelineConfig& config) {
  if (config.source->component.component().id != kVideo) return "";
  if (value_of(*config.source, "camera")) return "";
  const std::string device = value_of(*config.source, "device").value_or("-1");
  return "The camera is not calibrated, so depths are a guess: weft calibrate " +
         (device.starts_with('-') ? "FILES" : "--camera " + device) +
         " --out camera.yaml,\nthen --set source.camera=camera.yaml.\n";
}

/// A pipeline that comes with the program.
std::string own_pipeline(const char* name) {
  return (program_root() / "share/weft/pipelines" / name).string();
}

/// The file to run by default: a pipeline of `weft init` here, else one that comes with the
/// program.
std::string pipeline_of(const LiveOptions& options) {
  if (options.demo) return own_pipeline("live_demo.yaml");
  return fs::exists("live.yaml") ? "live.yaml" : own_pipeline("live.yaml");
}

/// The object to hold before the camera, if the pipeline is one of the program's.
std::string object_of(const LiveOptions& options, const std::string& pipeline) {
  if (pipeline != own_pipeline("live.yaml") || !options.video.empty()) return "";
  return "Show the camera " + own_pipeline("data/sheet_texture.png") +
         ", printed 297 mm wide.\nYour own image: weft init FOLDER, then weft live "
         "FOLDER/live.yaml.\n";
}

/// True if a pipeline could not run because a camera is missing.
bool is_about_camera(const PipelineConfig& config, const Error& error) {
  if (error.code == Errc::cancelled || config.source->component.component().id != kVideo) {
    return false;
  }
  const std::string device = value_of(*config.source, "device").value_or("-1");
  return error.where.ends_with(kVideo) && !device.starts_with('-');
}

constexpr const char* kAdvice =
    "weft live --demo shows a simulated surface, without a camera. With one:\n"
    "  another camera       --set source.device=1 (ls /dev/video*)\n"
    "  its calibration      weft calibrate --camera 0 --out camera.yaml, then\n"
    "                       --set source.camera=camera.yaml\n"
    "  your own image       weft init FOLDER, then weft live FOLDER/live.yaml\n"
    "  a photograph of it   weft template make --photo FILE --width METRES --out OBJECT, then\n"
    "                       weft init FOLDER --template OBJECT\n"
    "  a film               --video FILE\n";

constexpr const char* kCalibrationAdvice =
    "A camera's file is made by: weft calibrate --camera 0 --out camera.yaml\n";

constexpr const char* kPortAdvice = "Another port: --set live.address=127.0.0.1:8091\n";

std::string joined(const std::vector<std::string>& settings) {
  std::string text;
  for (const std::string& setting : settings) text += (text.empty() ? "" : ", ") + setting;
  return text;
}

/// Runs the pipeline, and again where a client of the page requests it with other settings. If
/// these do not lead to a run, the run before is started again with a warning: a camera may be
/// busy, and the page then stays connected.
void run_and_restart(RunArguments arguments, Context& context) {
  const std::atomic<bool>& interrupted = watch_for_interruption();
  const std::string folder = arguments.folder;
  std::vector<std::string> changed;  // settings of the restart that is tried
  std::vector<std::string> before = arguments.settings;
  bool has_started = false;
  std::string fault;
  arguments.started = [&has_started, started = arguments.started](const PipelineConfig& config) {
    if (!std::exchange(has_started, true)) started(config);
  };
  arguments.refused = [&fault, refused = arguments.refused](const ConfigReport& report) {
    fault = report.problems.empty() ? report.text() : report.problems.front().message;
    refused(report);
  };
  arguments.failed = [&fault, failed = arguments.failed](const PipelineConfig& config,
                                                         const Error& error) {
    fault = error.message;
    failed(config, error);
  };
  while (true) {
    has_started = false;
    const RunCounts counts = run(arguments, context);
    arguments.doubts.clear();
    if (interrupted.load()) return;
    if (counts.restart) {
      changed = *counts.restart;
      before = std::exchange(arguments.settings, with_settings(arguments.settings, changed));
    } else if (!has_started && !changed.empty()) {
      arguments.doubts = {"the run could not start with " + joined(changed) + ": " + fault +
                          ". It goes on as before"};
      arguments.settings = before;
      changed.clear();
      context.exit_code = kDone;
    } else {
      return;
    }
    if (!folder.empty()) arguments.folder = free_beside(folder);
  }
}

void run_live(const LiveOptions& options, Context& context) {
  if (options.demo && !(options.run.pipeline.empty() && options.video.empty())) {
    print_error(
        {Errc::invalid_value, "--demo stands alone: leave the pipeline and --video out", {}});
    context.exit_code = kBadConfiguration;
    return;
  }
  RunArguments arguments = options.run;
  if (arguments.pipeline.empty()) arguments.pipeline = pipeline_of(options);
  arguments.patches = {live_patch(options.record)};
  if (!options.video.empty()) arguments.patches.push_back(video_patch(options.video));
  arguments.keeps_records = options.keep;
  Browser browser;
  bool is_open = false;
  arguments.started = [&](const PipelineConfig& config) {
    const auto page = page_of(config);
    fmt::print("{}{}Ctrl-C ends it.\n{}", page ? words_on(*page) : "",
               object_of(options, arguments.pipeline), advice_for(config));
    std::fflush(stdout);
    if (page && !options.no_browser && !std::exchange(is_open, true)) {
      browser.open(page->address, page->token);
    }
  };
  arguments.refused = [](const ConfigReport& report) {
    const bool lacks_camera = report.text().find("'camera': there is no file") != std::string::npos;
    if (lacks_camera) fmt::print(stderr, "{}", kCalibrationAdvice);
  };
  arguments.failed = [](const PipelineConfig& config, const Error& error) {
    if (is_about_camera(config, error)) fmt::print(stderr, "{}", kAdvice);
    if (error.where.ends_with(kSink)) fmt::print(stderr, "{}", kPortAdvice);
  };
  arguments.restarts = true;
  run_and_restart(std::move(arguments), context);
}

}  // namespace

void add_live_command(CLI::App& app, Context& context) {
  const auto options = std::make_shared<LiveOptions>();
  CLI::App* command =
      app.add_subcommand("live", "Show in the browser what a camera sees, while it runs");
  command
      ->add_option("PIPELINE", options->run.pipeline,
                   "Pipeline file (default: live.yaml here, else the printed demo before camera 0)")
      ->type_name("");
  command->add_flag("--demo", options->demo, "A simulated surface instead of a camera");
  command->add_option("--video", options->video, "Play a film instead of a camera")
      ->option_text("FILE");
  command
      ->add_option("--out", options->run.folder,
                   "Run folder, new or empty (default: runs/<name of the pipeline>)")
      ->option_text("FOLDER");
  add_settings(*command, options->run.settings);
  add_isolation(*command, options->run.isolate);
  command->add_flag("--keep", options->keep,
                    "Keep the records of all frames in the run folder, not their lines only");
  command->add_flag("--record", options->record,
                    "Keep the frames that were taken in the run folder, see `weft run --repeat`");
  command->add_flag("--no-browser", options->no_browser, "Print the address, open nothing");
  command->callback([&context, options] { run_live(*options, context); });
}

}  // namespace weft::cli
