// SPDX-License-Identifier: Apache-2.0
#include "cli/data/sequence_maker.hpp"

#include <fmt/core.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <weft/core/whole_file.hpp>

#include "cli/ending/interruption.hpp"
#include "cli/ending/running_calls.hpp"
#include "cli/output/new_file.hpp"
#include "pipeline/runs/run.hpp"
#include "yaml/yaml.hpp"

namespace weft::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPipelineName = "make.yaml";

/// Frames that were made, on the terminal.
class SequenceProgress final : public RunObserver {
 public:
  explicit SequenceProgress(bool quiet) : shows_(!quiet && isatty(STDERR_FILENO) != 0) {}

  void started(std::int64_t frames) override { total_ = frames; }
  void frame_done(const FrameResult& frame) override {
    ++done_;
    for (const StageReport& report : frame.stages) {
      if (report.status != StageStatus::error || !first_error_.empty()) continue;
      first_error_ = fmt::format("frame {}: {}", frame.index, report.reason.str());
    }
    if (!shows_) return;
    // A failed write of the progress does not affect the frames.
    std::fputs(
        fmt::format("\r{}{} frames", done_, total_ < 0 ? "" : fmt::format("/{}", total_)).c_str(),
        stderr);
  }
  void calling(const std::string& stage, const std::string& component, const std::string& what,
               std::uint64_t frame) override {
    now_running(stage, component, what, frame);
  }
  void called() override { set_ended(); }
  void end_line() const {
    if (shows_ && done_ > 0) fmt::print(stderr, "\n");
  }
  const std::string& first_error() const { return first_error_; }

 private:
  bool shows_;
  std::int64_t done_ = 0, total_ = -1;
  std::string first_error_;
};

Result<void> write_pipeline(const std::string& text, const fs::path& folder) {
  if (auto made = make_new_folder(folder.string()); !made) return made;
  return write_whole(text, folder / kPipelineName);
}

/// Leaves what was there before, which is nothing, unless frames were finished.
void withdraw(const fs::path& folder, std::int64_t frames) {
  if (frames > 0) return;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    fs::remove_all(entry.path(), ignored);
  }
  fs::remove(folder, ignored);
}

}  // namespace

void make_sequence(const GeneratedText& pipeline_text, const std::string& folder,
                   const std::vector<std::string>& settings, bool quiet,
                   std::int64_t (*frames_in)(const std::string&), const Error& none,
                   Context& context) {
  if (auto written = write_pipeline(pipeline_text.text(), folder); !written) {
    print_error(written.error());
    context.exit_code = kInputOutput;
    return;
  }
  const auto registry = context.registry();
  const std::string file = (fs::path(folder) / kPipelineName).string();
  const auto [pipeline, report] =
      check_pipeline(file, registry, fs::absolute(folder).string(), settings);
  if (!report.ok()) {
    fmt::print(stderr, "{}", pipeline_text.report_text(report, file));
    withdraw(folder, frames_in(folder));
    context.exit_code = kBadConfiguration;
    return;
  }
  const std::atomic<bool>& interrupted = watch_for_interruption();
  SequenceProgress progress(quiet);
  const auto summary = run_pipeline(pipeline, "", progress, interrupted);
  now_running("the summary");
  progress.end_line();
  if (!summary) {
    print_error(summary.error());
    withdraw(folder, frames_in(folder));
    context.exit_code = summary.error().code == Errc::io ? kInputOutput : kBadConfiguration;
    return;
  }
  if (!progress.first_error().empty()) fmt::print(stderr, "error: {}\n", progress.first_error());
  const bool gave_up = summary->stopped && !summary->cancelled;
  if (summary->failed > 0 || gave_up) context.exit_code = kFramesFailed;
  const std::int64_t written = frames_in(folder);
  if (summary->cancelled && written == 0) {
    fmt::print("interrupted before the first frame was finished: nothing is left\n");
    withdraw(folder, frames_in(folder));
    return;
  }
  if (written == 0 && context.exit_code == kDone) {
    print_error(none);
    withdraw(folder, frames_in(folder));
    context.exit_code = kFramesFailed;
    return;
  }
  const std::int64_t left_out = summary->frames - summary->failed - written;
  fmt::print("{} frames{}, {} failed{}: {}\n", summary->frames,
             left_out > 0 ? fmt::format(", {} omitted", left_out) : "", summary->failed,
             summary->stopped ? ", stopped early" : "", folder);
}

std::int64_t frames_in_sequence(const std::string& folder) {
  std::error_code ignored;
  const fs::directory_iterator entries(fs::path(folder) / "frames", ignored);
  return std::count_if(begin(entries), end(entries),
                       [](const auto& entry) { return entry.path().extension() == ".png"; });
}

std::int64_t frames_in_shards(const std::string& folder) {
  std::ifstream file(fs::path(folder) / "shards.json");
  const auto text = nlohmann::json::parse(file, nullptr, false);
  if (text.is_object() && text.contains("frames") && text["frames"].is_number_integer()) {
    return text["frames"].get<std::int64_t>();
  }
  // A run that broke off has not counted them, but each shard has one at least.
  std::error_code ignored;
  const fs::directory_iterator entries(folder, ignored);
  return std::count_if(begin(entries), end(entries), [](const auto& entry) {
    return fs::exists(entry.path() / "image.npy") && entry.path().extension() != ".part";
  });
}

std::string yaml_quoted(const std::string& text) {
  std::string emitted = yaml::emit(yaml::text_node(text));
  while (!emitted.empty() && emitted.back() == '\n') emitted.pop_back();
  return emitted;
}

}  // namespace weft::cli
