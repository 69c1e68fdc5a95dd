// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <memory>
#include <weft/host/yaml.hpp>
#include <weft/pipeline/run.hpp>

#include "data_commands.hpp"

namespace weft::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPipelineName = "make.yaml";

// A signal handler can reach nothing but an object with static storage.
std::atomic<bool> interrupted{false};

struct Options {
  std::string folder, texture, pattern, background;
  double width_m = 0.297;
  double height_m = 0.0;
  std::int64_t frames = 60;
  std::int64_t seed = 1;
  bool occluder = false;
  std::vector<std::string> settings;
  bool quiet = false;
};

/// Frames that were made, on the terminal.
class Progress final : public RunObserver {
 public:
  explicit Progress(bool quiet) : quiet_(quiet) {}

  void started(std::int64_t frames) override { total_ = frames; }
  void frame_done(const FrameResult& frame) override {
    ++done_;
    for (const StageReport& report : frame.stages) {
      if (report.status == StageStatus::error && first_error_.empty()) {
        first_error_ = fmt::format("frame {}: {}", frame.index, report.reason);
      }
    }
    if (!quiet_) fmt::print(stderr, "\r{}/{} frames", done_, total_);
  }
  void end_line() const {
    if (!quiet_ && done_ > 0) fmt::print(stderr, "\n");
  }
  const std::string& first_error() const { return first_error_; }

 private:
  bool quiet_;
  std::int64_t done_ = 0, total_ = 0;
  std::string first_error_;
};

/// A text as YAML, whatever it holds.
std::string quoted(const std::string& text) {
  yaml::Node node;
  node.kind = yaml::Kind::scalar;
  node.scalar = text;
  node.quoted = true;
  std::string emitted = yaml::emit(node);
  while (!emitted.empty() && emitted.back() == '\n') emitted.pop_back();
  return emitted;
}

std::string one_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
  return text;
}

/// The pipeline that makes the sequence. It stands in the sequence and says how it was made, so it
/// does not depend on where that is.
std::string pipeline_text(const Options& options) {
  const std::string texture = quoted(fs::absolute(options.texture).lexically_normal().string());
  const std::string size =
      fmt::format("    width_m: {}\n    height_m: {}\n", options.width_m, options.height_m);
  std::string text = "# Made by `weft data make frex`; `weft run` of this file makes it again";
  text += options.settings.empty() ? ".\n" : ", with:\n";
  for (const std::string& setting : options.settings)
    text += "#   --set " + one_line(setting) + "\n";
  text += "weft: 1\non_error: stop\nsource:\n  use: sources/frex\n  params:\n";
  text += "    texture: " + texture + "\n" + size;
  text += fmt::format("    frames: {}\n    seed: {}\n", options.frames, options.seed);
  if (!options.pattern.empty()) text += "    pattern: " + quoted(options.pattern) + "\n";
  if (!options.background.empty()) text += "    background: " + quoted(options.background) + "\n";
  if (options.occluder) text += "    occluder: true\n";
  text +=
      "template:\n  use: templates/rectangular\n  params:\n    texture: " + texture + "\n" + size;
  text += "    columns: 10\n    rows: 7\nsinks:\n  - use: sinks/dataset\n    params: {path: .}\n";
  return text;
}

Result<void> write_pipeline(const Options& options) {
  std::error_code code;
  const fs::path folder(options.folder);
  if (fs::exists(folder, code) && !(fs::is_directory(folder, code) && fs::is_empty(folder, code))) {
    return Error{Errc::io, "exists and is not an empty folder; choose another with --out",
                 options.folder};
  }
  fs::create_directories(folder, code);
  if (code) return Error{Errc::io, "cannot be created: " + code.message(), options.folder};
  std::ofstream stream(folder / kPipelineName, std::ios::binary);
  stream << pipeline_text(options);
  stream.close();
  if (stream) return {};
  return Error{Errc::io, "cannot be written; is the disk full?", (folder / kPipelineName).string()};
}

/// Nothing was made: what was there before is left.
void withdraw(const Options& options) {
  std::error_code ignored;
  fs::remove(fs::path(options.folder) / kPipelineName, ignored);
  fs::remove(options.folder, ignored);
}

void make(const Options& options, Context& context) {
  if (auto written = write_pipeline(options); !written) {
    print_error(written.error());
    context.exit_code = kInputOutput;
    return;
  }
  const auto registry = context.registry();
  const std::string file = (fs::path(options.folder) / kPipelineName).string();
  const auto [pipeline, report] =
      check_pipeline(file, registry, fs::absolute(options.folder).string(), options.settings);
  if (!report.ok()) {
    fmt::print(stderr, "{}", report.text());
    withdraw(options);
    context.exit_code = kBadConfiguration;
    return;
  }
  std::signal(SIGINT, [](int) { interrupted = true; });
  std::signal(SIGTERM, [](int) { interrupted = true; });
  Progress progress(options.quiet);
  const auto summary = run_pipeline(pipeline, "", progress, interrupted);
  progress.end_line();
  if (!summary) {
    print_error(summary.error());
    const bool io = summary.error().code == Errc::io;
    if (!io) withdraw(options);
    context.exit_code = io ? kInputOutput : kBadConfiguration;
    return;
  }
  if (!progress.first_error().empty()) fmt::print(stderr, "error: {}\n", progress.first_error());
  fmt::print("{} frames, {} failed{}: {}\n", summary->frames, summary->failed,
             summary->stopped ? ", stopped early" : "", options.folder);
  if (summary->failed > 0 || summary->stopped) context.exit_code = kFramesFailed;
}

}  // namespace

void add_data_make_frex(CLI::App& make_command, Context& context) {
  const auto options = std::make_shared<Options>();
  CLI::App* command = make_command.add_subcommand(
      "frex", "Simulate a printed sheet before a camera: sources/frex into sinks/dataset");
  command->add_option("--out", options->folder, "Folder of the sequence, new or empty")->required();
  command->add_option("--texture", options->texture, "Image printed on the sheet")->required();
  command->add_option("--width-m", options->width_m, "Width of the sheet")->capture_default_str();
  command->add_option("--height-m", options->height_m, "Height of the sheet; 0: texels are square")
      ->capture_default_str();
  command->add_option("--frames", options->frames, "Number of frames")->capture_default_str();
  command->add_option("--seed", options->seed, "Chooses movement, light, background and noise")
      ->capture_default_str();
  command->add_option("--pattern", options->pattern,
                      "roll, s_bend, corner_fold, wave, handles or bulge");
  command->add_option("--background", options->background, "plain, clutter, look_alike or image");
  command->add_flag("--occluder", options->occluder, "An arm hides parts of the sheet");
  command
      ->add_option("--set", options->settings,
                   "PATH=VALUE, such as source.noise_grey=4 or source.cut_frames=[20]; may be "
                   "repeated; see `weft plugins show sources/frex`")
      ->allow_extra_args(false);
  command->add_flag("--quiet", options->quiet, "No progress");
  command->callback([&context, options] { make(*options, context); });
}

}  // namespace weft::cli
