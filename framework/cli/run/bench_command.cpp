// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>
#include <time.h>
#include <unistd.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <weft/core/whole_file.hpp>

#include "cli/commands.hpp"
#include "cli/ending/interruption.hpp"
#include "cli/output/new_file.hpp"
#include "cli/output/report_text.hpp"
#include "cli/output/scratch_folder.hpp"
#include "cli/run/bench_options.hpp"
#include "cli/run/run_settings.hpp"
#include "host/loading/processor.hpp"
#include "lab/bench/report.hpp"

namespace weft::cli {
namespace {

namespace fs = std::filesystem;
using bench::PipelineSubject;

/// Ends the command with a message and an exit code.
struct Ended {
  Error error;
  int exit_code;
};

[[noreturn]] void end(Error error, int exit_code) {
  if (error.code == Errc::cancelled) {
    throw Ended{{error.code, "no result is printed", "interrupted"}, kFramesFailed};
  }
  throw Ended{std::move(error), exit_code};
}

/// The value of a result; an error is one of this file.
template <class T>
T need(Result<T> result, const std::string& file) {
  if (result) return *std::move(result);
  Error error = result.error();
  const int exit_code = error.code == Errc::io ? kInputOutput : kBadConfiguration;
  if (error.where != file) error.where = file + (error.where.empty() ? "" : ": " + error.where);
  end(std::move(error), exit_code);
}

/// Returns a measurement; a frame with an error ends the command.
template <class T>
T need(Result<T> measured) {
  if (!measured) end(measured.error(), kFramesFailed);
  return *std::move(measured);
}

/// Output folder of a pipeline's sinks, inside the scratch folder.
std::string sink_folder(const ScratchFolder& scratch, std::size_t pipeline) {
  std::string folder = scratch.path() + "/" + std::to_string(pipeline);
  std::error_code ignored;  // sinks report files that they cannot write
  fs::create_directories(folder, ignored);
  return folder;
}

/// The pipelines, or nothing where one of them is wrong, which has been printed.
std::vector<CheckedPipeline> check_all(const std::vector<bench::Entry>& entries,
                                       const host::Registry& registry,
                                       const std::optional<ScratchFolder>& scratch) {
  std::vector<CheckedPipeline> pipelines;
  bool ok = true;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const std::string folder =
        scratch ? sink_folder(*scratch, i) : fs::absolute(free_folder(entries[i].file)).string();
    host::ComponentChecks checks = checks_of(entries[i].file);
    auto [pipeline, report] =
        check_pipeline(entries[i].file, registry, folder, entries[i].settings, {}, &checks);
    if (!report.ok()) print_report(report);
    ok = ok && report.ok();
    pipelines.push_back(scratch ? std::move(pipeline) : bench::without_sinks(std::move(pipeline)));
  }
  return ok ? std::move(pipelines) : std::vector<CheckedPipeline>{};
}

/// Counts in a separate process that runs nothing but this pipeline.
Result<bench::Counts> count(const bench::Entry& entry, const bench::Settings& how, bool with_sinks,
                            const Context& context, const std::atomic<bool>& interrupted) {
  std::error_code code;
  const fs::path self = fs::read_symlink("/proc/self/exe", code);
  const fs::path library =
      self.parent_path().parent_path() / "lib/weft/libweft_count_allocations.so";
  std::vector<std::string> command{self.string()};
  for (const std::string& folder : context.plugin_path) {
    command.insert(command.end(), {"--plugin-path", folder});
  }
  command.insert(command.end(), {"bench", "--counts"});
  const std::vector<std::string> words = counting_words(entry, how, with_sinks);
  command.insert(command.end(), words.begin(), words.end());
  return bench::count_in_child(command, library.string(), interrupted);
}

void show_progress(std::size_t done, std::size_t turns) {
  fmt::print(stderr, "\r{:<40}", done < turns ? fmt::format("turn {} of {}", done, turns) : "");
  if (done == turns) fmt::print(stderr, "\r");
}

/// Time of this thread alone: waiting for a core does not count.
double processor_ms() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

bench::Settings settled_frames(const BenchOptions& options,
                               const std::vector<std::unique_ptr<PipelineSubject>>& subjects) {
  auto settings = bench::settled(options.how, subjects, options.frames_given);
  if (!settings) end(settings.error(), kBadConfiguration);
  return *settings;
}

bench::Report measure_all(const BenchOptions& options, const std::vector<bench::Entry>& entries,
                          std::vector<CheckedPipeline> pipelines, const Context& context,
                          const std::atomic<bool>& interrupted) {
  std::vector<std::unique_ptr<PipelineSubject>> subjects;
  std::vector<bench::Subject*> measured;
  for (std::size_t i = 0; i < pipelines.size(); ++i) {
    now_running("the first frames of " + entries[i].file);
    subjects.push_back(
        need(PipelineSubject::open(std::move(pipelines[i]), options.how.all_frames(), interrupted),
             entries[i].file));
    measured.push_back(subjects.back().get());
  }
  bench::Report report;
  report.settings = settled_frames(options, subjects);
  report.command = command_of(options, report.settings, context);
  report.processor = host::processor_name();
  now_running("the measurement of this machine");
  report.speed = bench::measure_machine(processor_ms);
  now_running("the pipelines");
  const bool show = !options.quiet && isatty(STDERR_FILENO) != 0;
  const auto progress = show ? show_progress : bench::Progress();
  const auto samples = need(bench::measure(report.settings, measured, progress));
  std::vector<std::vector<bench::Overlapped>> overlapped(subjects.size());
  if (options.overlap) {
    now_running("the pipelines, several frames at once");
    overlapped = need(bench::measure_overlap(report.settings, measured, progress));
  }
  report.speed = better_of(report.speed, bench::measure_machine(processor_ms));
  if (entries.size() > 1) report.baseline = entries.back().name;
  now_running("the pipelines once more, each in a process that counts");
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const auto counts =
        count(entries[i], report.settings, options.with_sinks, context, interrupted);
    report.pipelines.push_back(
        bench::report_of(entries[i], *subjects[i], samples[i], counts, report.speed));
    if (!options.overlap) continue;
    add_overlap(*subjects[i], overlapped[i], report.settings.warmup, report.pipelines.back());
  }
  report.ratios = bench::ratios_of(report.pipelines, report.baseline);
  return report;
}

/// Prints the counts in the process that only counts.
void print_counts(const BenchOptions& options, const CheckedPipeline& pipeline,
                  const std::atomic<bool>& interrupted) {
  const auto counts = need(bench::count_here(pipeline, options.how, interrupted), options.pipeline);
  fmt::print("{}\n", bench::text_of(counts));
}

void bench_pipelines(const BenchOptions& options, Context& context) {
  const std::atomic<bool>& interrupted = watch_for_interruption();
  if (!options.json.empty()) {
    const auto free = check_new_file(options.json, options.overwrite);
    if (!free) end(free.error(), kInputOutput);
  }
  const std::vector<bench::Entry> entries = entries_of(options);
  const auto registry = context.registry();
  std::optional<ScratchFolder> scratch;
  if (options.with_sinks) {
    auto made = ScratchFolder::make("weft-bench");
    if (!made) end(made.error(), kInputOutput);
    scratch.emplace(*std::move(made));
  }
  auto pipelines = check_all(entries, registry, scratch);
  if (pipelines.empty()) {
    context.exit_code = kBadConfiguration;
    return;
  }
  if (options.counts) return print_counts(options, pipelines.front(), interrupted);
  const bench::Report report =
      measure_all(options, entries, std::move(pipelines), context, interrupted);
  fmt::print("{}", bench::table_of(report));
  if (options.json.empty()) return;
  const auto written = write_whole(bench::json_of(report), options.json);
  if (!written) end(written.error(), kInputOutput);
}

}  // namespace

void add_bench_command(CLI::App& app, Context& context) {
  const auto options = std::make_shared<BenchOptions>();
  CLI::App* command = app.add_subcommand(
      "bench", "Measure times, allocations and memory of pipelines, in turns, stage by stage");
  add_bench_options(*command, *options);
  command->footer(
      "Exit codes:\n"
      "  0  done\n"
      "  1  a frame had an error, or it was interrupted; no result\n"
      "  2  the command line or a pipeline is wrong, or its source has too few frames\n"
      "  3  a file or folder could not be read or written");
  command->callback([&context, options, command] {
    options->frames_given = command->count("--frames") > 0;
    try {
      bench_pipelines(*options, context);
    } catch (const Ended& ended) {
      print_error(ended.error);
      context.exit_code = ended.exit_code;
    }
  });
}

}  // namespace weft::cli
