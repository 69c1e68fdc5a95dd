// SPDX-License-Identifier: Apache-2.0
#include "lab/bench/report.hpp"

#include <algorithm>
#include <filesystem>
#include <set>
#include <weft/core/index.hpp>

namespace weft::bench {
namespace {

Spread spread_of_times(const std::vector<PartSample>& samples, double host::Spent::*time) {
  std::vector<double> values;
  for (const PartSample& sample : samples) values.push_back(sample.took.*time);
  return spread_of(values);
}

Row row_of(const Part& part, const std::string& component) {
  Row row{part.name, component, {}, {}, {}, {}, {}, {}};
  row.ms = spread_of_times(part.samples, &host::Spent::ms);
  row.processor_ms = spread_of_times(part.samples, &host::Spent::processor_ms);
  for (std::size_t i = 0; i < part.statuses.size(); ++i) {
    const auto status = static_cast<StageStatus>(i);
    if (part.statuses[i] > 0) row.statuses[to_string(status)] = part.statuses[i];
  }
  return row;
}

/// The source reads each frame once; those that warm up do not count.
Row row_of_source(const PipelineSubject& subject, std::int64_t warmup) {
  const StageConfig& source = *subject.config().source;
  Part part{source.name, {}, {}};
  const std::vector<StageReport>& reading = subject.reading();
  for (std::size_t i = to_index(warmup); i < reading.size(); ++i) {
    part.samples.push_back({0, 0, static_cast<std::int64_t>(i), reading[i].took});
  }
  return row_of(part, source.component.component().id);
}

void add_moved(const PipelineSubject& subject, const MachineSpeed& speed, std::vector<Row>& rows) {
  for (std::size_t i = 0; i < subject.moved().size(); ++i) {
    const PipelineSubject::MovedInAll& all = subject.moved()[i];
    if (all.runs == 0) continue;
    const auto runs = to_index(all.runs);
    Row& row = rows[i + 1];
    row.moved = Moved{all.bytes.in / runs, all.bytes.out / runs};
    row.floor_ms = floor_ms(static_cast<double>(row.moved->in + row.moved->out), speed);
  }
}

void add_counts(const Counts& counts, std::vector<Row>& rows) {
  for (const PartCount& count : counts.parts) {
    const auto same = [&](const Row& row) { return row.part == count.name; };
    const auto row = std::find_if(rows.begin(), rows.end(), same);
    if (row == rows.end()) continue;
    row->blocks = spread_of(count.blocks);
    row->bytes = spread_of(count.bytes);
  }
}

const Part* find_part(const PipelineReport& pipeline, const std::string& name) {
  for (const Part& part : pipeline.parts) {
    if (part.name == name) return &part;
  }
  return nullptr;
}

void add_ratios(const PipelineReport& one, const PipelineReport& other,
                std::vector<RatioReport>& ratios) {
  std::vector<std::string> names{kFrame};
  for (const Part& part : one.parts) {
    if (part.name != kFrame) names.push_back(part.name);
  }
  for (const std::string& name : names) {
    const Part *part = find_part(one, name), *over = find_part(other, name);
    if (part == nullptr || over == nullptr) continue;
    ratios.push_back({one.entry.name, other.entry.name, name, ratio_of(*part, *over, Time::wall),
                      ratio_of(*part, *over, Time::processor)});
  }
}

}  // namespace

void name_entries(std::vector<Entry>& entries) {
  std::set<std::string> taken;
  for (Entry& entry : entries) {
    const std::string stem = std::filesystem::path(entry.file).stem().string();
    entry.name = stem;
    for (int i = 2; !taken.insert(entry.name).second; ++i) {
      entry.name = stem + "#" + std::to_string(i);
    }
  }
}

double times_floor(const Row& row) {
  return row.floor_ms > 0.0 ? row.processor_ms.median / row.floor_ms : kUnknown;
}

PipelineReport report_of(const Entry& entry, const PipelineSubject& subject,
                         const std::vector<Sample>& samples, const Result<Counts>& counts,
                         const MachineSpeed& speed) {
  PipelineReport report;
  report.entry = entry;
  report.states = subject.states();
  report.parts = parts_of(subject.parts(), samples);
  const std::int64_t warmup = samples.empty() ? 0 : samples.front().frame;
  report.rows.push_back(row_of_source(subject, warmup));
  std::vector<std::string> components = subject.components();
  components.resize(report.parts.size());
  for (std::size_t i = 0; i < report.parts.size(); ++i) {
    Row& row = report.rows.emplace_back(row_of(report.parts[i], components[i]));
    if (components[i].empty()) row.statuses.clear();
  }
  add_moved(subject, speed, report.rows);
  if (counts) {
    report.counts = *counts;
    if (!counts->allocations) report.why_no_counts = "the library that counts is not there";
    add_counts(*counts, report.rows);
  } else {
    report.why_no_counts = counts.error().message;
  }
  return report;
}

void add_overlap(const PipelineSubject& subject, const std::vector<Overlapped>& repetitions,
                 std::int64_t warmup, PipelineReport& report) {
  report.overlap = figures_of(repetitions, warmup);
  report.overlap->frames_at_once = frames_at_once_of(subject.config());
  report.overlap->threads = workers_of(subject.config());
  report.parts.push_back(overlapped_part(repetitions, warmup));
}

std::vector<RatioReport> ratios_of(const std::vector<PipelineReport>& pipelines,
                                   const std::string& baseline) {
  std::vector<RatioReport> ratios;
  for (std::size_t i = 1; i < pipelines.size(); ++i) {
    add_ratios(pipelines.front(), pipelines[i], ratios);
  }
  const auto named = [&](const PipelineReport& each) { return each.entry.name == baseline; };
  const auto base = std::find_if(pipelines.begin(), pipelines.end(), named);
  if (base == pipelines.end()) return ratios;
  for (std::size_t i = 1; i < pipelines.size(); ++i) {
    if (&pipelines[i] != &*base) add_ratios(pipelines[i], *base, ratios);
  }
  return ratios;
}

}  // namespace weft::bench
