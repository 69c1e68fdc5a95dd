// SPDX-License-Identifier: Apache-2.0
#include "lab/bench/counts.hpp"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <weft/core/index.hpp>

#include "lab/bench/figures.hpp"
#include "lab/bench/pipeline_subject.hpp"
#include "pipeline/runs/frame_loop.hpp"
#include "process/child.hpp"

namespace weft::bench {
namespace {

using nlohmann::json;

/// A line of /proc/self/status such as "VmHWM:    1234 kB".
double status_kib(const std::string& wanted) {
  std::ifstream stream("/proc/self/status");
  std::string name, rest;
  double kib = 0.0;
  while (stream >> name) {
    if (name == wanted + ":" && stream >> kib) return kib;
    std::getline(stream, rest);
  }
  return 0.0;
}

/// The kernel's record of the peak begins anew; where it does not let us, it goes on, which is
/// seldom much higher.
void forget_peak() { std::ofstream("/proc/self/clear_refs") << "5"; }

Result<void> load_all(const host::ComponentSpec& spec) {
  if (const auto table = host::load(*spec.installed); !table) return table.error();
  for (const host::NestedSpec& nested : spec.nested) {
    if (auto loaded = load_all(nested.component); !loaded) return loaded;
  }
  return {};
}

/// The libraries that a run has in this process.
Result<void> load_all(const PipelineConfig& config) {
  for (const auto* single : {&config.source, &config.templ}) {
    if ((*single)->isolation) continue;
    if (auto loaded = load_all((*single)->component); !loaded) return loaded;
  }
  for (const auto* list : {&config.stages, &config.sinks}) {
    for (const StageConfig& stage : *list) {
      if (stage.isolation) continue;
      if (auto loaded = load_all(stage.component); !loaded) return loaded;
    }
  }
  return {};
}

/// Reads and runs the frames; the samples are those of frames that count, with the source's first.
Result<std::vector<Sample>> run_frames(FrameLoop& loop, const Settings& settings,
                                       const std::atomic<bool>& cancel) {
  std::vector<Sample> samples;
  for (std::int64_t index = 0; index < settings.all_frames(); ++index) {
    const auto read = loop.input().read(to_index(index));
    if (!read) break;
    const host::Stopwatch watch;
    FrameResult result = loop.process(*read);
    if (!result.failed()) loop.finish(result);
    const host::Spent here = watch.spent();
    if (result.failed()) return error_of(result, cancel.load());
    if (index < settings.warmup) continue;
    Sample& sample = samples.emplace_back();
    sample.frame = index;
    sample.spent = spent_in(result, here);
  }
  return samples;
}

std::vector<PartCount> counts_of(const std::vector<Part>& parts) {
  std::vector<PartCount> counts;
  for (const Part& part : parts) {
    PartCount& count = counts.emplace_back();
    count.name = part.name;
    for (const PartSample& sample : part.samples) {
      count.blocks.push_back(static_cast<double>(sample.took.allocations.blocks));
      count.bytes.push_back(static_cast<double>(sample.took.allocations.bytes));
    }
  }
  return counts;
}

}  // namespace

Result<Counts> count_here(const CheckedPipeline& pipeline, const Settings& settings,
                          const std::atomic<bool>& cancel) {
  Counts counts;
  if (auto loaded = load_all(pipeline.config); !loaded) return loaded.error();
  forget_peak();
  counts.loaded_kib = status_kib("VmRSS");
  auto context = context_of(pipeline.config, {});
  if (!context) return context.error();
  (*context)->cancellation().watch([&cancel] { return cancel.load(); });
  auto loop = FrameLoop::open(pipeline, **context);
  if (!loop) return loop.error();
  if (auto opened = (*loop)->open_sinks(); !opened) return opened.error();
  auto samples = run_frames(**loop, settings, cancel);
  if (!samples) return samples.error();
  if (auto closed = (*loop)->close_sinks(); !closed) return closed.error();
  counts.peak_kib = status_kib("VmHWM");
  counts.allocations = host::allocations_are_counted();
  if (!counts.allocations) return counts;
  std::vector<std::string> names;
  for (const auto* list : {&pipeline.config.stages, &pipeline.config.sinks}) {
    for (const StageConfig& stage : *list) names.push_back(stage.name);
  }
  counts.parts = counts_of(parts_of(names, *samples));
  return counts;
}

std::string text_of(const Counts& counts) {
  json parts = json::array();
  for (const PartCount& part : counts.parts) {
    parts.push_back({{"name", part.name}, {"blocks", part.blocks}, {"bytes", part.bytes}});
  }
  return json{{"schema", "weft-bench-counts/1"},
              {"allocations", counts.allocations},
              {"parts", parts},
              {"loaded_kib", counts.loaded_kib},
              {"peak_kib", counts.peak_kib}}
      .dump();
}

Result<Counts> counts_in(const std::string& text) try {
  const json all = json::parse(text);
  Counts counts;
  if (all.at("schema") != "weft-bench-counts/1")
    return Error{Errc::incompatible, "of another version", {}};
  all.at("allocations").get_to(counts.allocations);
  all.at("loaded_kib").get_to(counts.loaded_kib);
  all.at("peak_kib").get_to(counts.peak_kib);
  for (const json& part : all.at("parts")) {
    counts.parts.push_back({part.at("name"), part.at("blocks"), part.at("bytes")});
  }
  return counts;
} catch (const json::exception& error) {
  return Error{Errc::invalid_data, std::string("cannot be read: ") + error.what(), {}};
}

Result<Counts> count_in_child(const std::vector<std::string>& command, const std::string& library,
                              const std::atomic<bool>& cancel) {
  std::vector<std::string> settings;
  if (std::error_code code; std::filesystem::exists(library, code)) {
    const char* others = std::getenv("LD_PRELOAD");
    settings.push_back("LD_PRELOAD=" + library + (others != nullptr ? ":" : "") +
                       (others != nullptr ? others : ""));
  }
  const auto child = process::Child::start(
      process::Program{.words = command, .settings = settings, .out = process::kPipe});
  if (!child) return child.error();
  (*child)->listen([&] { return !cancel.load(); });
  // Time to remove what its sinks have written; a component may not react to SIGTERM.
  const process::Ending ending = (*child)->end(std::chrono::seconds(5));
  if (cancel.load()) return Error{Errc::cancelled, "cancelled", {}};
  if (ending.exit_code != 0 || ending.signal != 0) {
    return Error{Errc::io, "the process that counts failed", {}};
  }
  return counts_in((*child)->out());
}

}  // namespace weft::bench
