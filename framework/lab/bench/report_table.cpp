// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lab/bench/report.hpp"

namespace weft::bench {
namespace {

using Line = std::vector<std::string>;

/// Columns of equal width: the first ones text, the others figures to the right.
std::string aligned(const std::vector<Line>& lines, std::size_t text_columns) {
  std::vector<std::size_t> widths(lines.front().size());
  for (const Line& line : lines) {
    for (std::size_t i = 0; i < line.size(); ++i) widths[i] = std::max(widths[i], line[i].size());
  }
  std::string text;
  for (const Line& line : lines) {
    std::string row;
    for (std::size_t i = 0; i < line.size(); ++i) {
      row += i < text_columns ? fmt::format("{:<{}}  ", line[i], widths[i])
                              : fmt::format("{:>{}}  ", line[i], widths[i]);
    }
    text += row.substr(0, row.find_last_not_of(' ') + 1) + "\n";
  }
  return text;
}

std::string figure(double value, const char* form) {
  return std::isfinite(value) ? fmt::format(fmt::runtime(form), value) : "-";
}

std::string ms_text(double ms) {
  return figure(ms, std::abs(ms) < 0.1 ? "{:.4f}" : std::abs(ms) < 10.0 ? "{:.3f}" : "{:.1f}");
}

std::string relative(const Report& report, const PipelineReport& pipeline,
                     const std::string& part) {
  if (pipeline.entry.name == report.baseline) return "1";
  for (const RatioReport& ratio : report.ratios) {
    const bool same = ratio.of == pipeline.entry.name && ratio.over == report.baseline;
    if (same && ratio.part == part) return figure(ratio.wall.ratio, "{:.3f}");
  }
  return "-";
}

Line line_of(const Report& report, const PipelineReport& pipeline, const Row& row) {
  Line line{row.part, row.component};
  for (const double ms : {row.ms.median, row.ms.p95, row.ms.p99, row.processor_ms.median}) {
    line.push_back(ms_text(ms));
  }
  if (!report.baseline.empty()) line.push_back(relative(report, pipeline, row.part));
  line.push_back(row.blocks ? figure(row.blocks->median, "{:.0f}") : "-");
  line.push_back(row.bytes ? figure(row.bytes->median / 1024.0, "{:.1f}") : "-");
  const double moved =
      row.moved ? static_cast<double>(row.moved->in + row.moved->out) / 1024.0 : kUnknown;
  line.push_back(figure(moved, "{:.1f}"));
  line.push_back(figure(row.floor_ms, "{:.4f}"));
  line.push_back(figure(times_floor(row), "{:.0f}"));
  return line;
}

std::string overlap_text(const OverlapFigures& overlap) {
  const auto [least, most] =
      std::minmax_element(overlap.frames_per_s.begin(), overlap.frames_per_s.end());
  return fmt::format(
      "overlapped, {} frames at once on {} threads: {} frames/s ({} to {}), latency ms p50 {}, "
      "p95 {}, p99 {}, {} cores\n",
      overlap.frames_at_once, overlap.threads, figure(overlap.frames_per_s_spread.median, "{:.2f}"),
      figure(*least, "{:.2f}"), figure(*most, "{:.2f}"), ms_text(overlap.latency_ms.median),
      ms_text(overlap.latency_ms.p95), ms_text(overlap.latency_ms.p99),
      figure(overlap.cores, "{:.2f}"));
}

std::string text_of(const Report& report, const PipelineReport& pipeline) {
  std::string states;
  for (const auto& [state, count] : pipeline.states) {
    states += fmt::format(", {} {}", count, state);
  }
  std::string text = fmt::format("{}: {}", pipeline.entry.name, pipeline.entry.file);
  for (const std::string& setting : pipeline.entry.settings) text += " --set " + setting;
  text += states + "\n";
  Line head{"part", "component", "ms p50", "p95", "p99", "cpu p50"};
  if (!report.baseline.empty()) head.push_back("/ " + report.baseline);
  for (const char* name : {"allocations", "KiB", "records KiB", "floor ms", "cpu / floor"}) {
    head.emplace_back(name);
  }
  std::vector<Line> lines{head};
  for (const Row& row : pipeline.rows) lines.push_back(line_of(report, pipeline, row));
  text += aligned(lines, 2);
  if (pipeline.overlap) text += overlap_text(*pipeline.overlap);
  if (pipeline.counts) {
    const Counts& counts = *pipeline.counts;
    text += fmt::format("memory: {:.1f} MiB at most, {:.1f} above the {:.1f} of its libraries\n",
                        counts.peak_kib / 1024.0, (counts.peak_kib - counts.loaded_kib) / 1024.0,
                        counts.loaded_kib / 1024.0);
  }
  if (!pipeline.why_no_counts.empty()) {
    text += "allocations were not counted: " + pipeline.why_no_counts + "\n";
  }
  return text;
}

std::string with_interval(const Ratio& ratio) {
  return figure(ratio.ratio, "{:.3f}") + " (" + figure(ratio.interval.low, "{:.3f}") + " to " +
         figure(ratio.interval.high, "{:.3f}") + ")";
}

std::string ratios_text(const Report& report) {
  std::vector<Line> lines{{"ratio of times", "part", "wall", "processor"}};
  for (const RatioReport& each : report.ratios) {
    lines.push_back({each.of + " / " + each.over, each.part, with_interval(each.wall),
                     with_interval(each.processor)});
  }
  return aligned(lines, 2);
}

std::string rate(double per_s, const char* unit) {
  return per_s > 0.0 ? fmt::format("{:.1f} {}", per_s / 1e9, unit) : "-";
}

}  // namespace

std::string table_of(const Report& report) {
  const Settings& settings = report.settings;
  std::string text = fmt::format(
      "{} repetitions of {} frames after {} to warm up, in turns of {}; times in ms a frame\n\n",
      settings.repetitions, settings.frames, settings.warmup, settings.block);
  for (const PipelineReport& each : report.pipelines) text += text_of(report, each) + "\n";
  if (!report.ratios.empty()) text += ratios_text(report) + "\n";
  const MachineSpeed& speed = report.speed;
  text += fmt::format("{}, one thread: copies {} in L1, {} in L2, {} in memory; {} multiply-adds\n",
                      report.processor, rate(speed.l1_bytes_per_s, "GB/s"),
                      rate(speed.l2_bytes_per_s, "GB/s"), rate(speed.memory_bytes_per_s, "GB/s"),
                      rate(speed.multiply_adds_per_s, "G/s"));
  return text;
}

}  // namespace weft::bench
