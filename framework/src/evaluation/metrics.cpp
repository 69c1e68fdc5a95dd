// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <weft/core/statistics.hpp>
#include <weft/evaluation/metrics.hpp>
#include <weft/evaluation/run_reader.hpp>
#include <weft/evaluation/shape_meter.hpp>

#include "frame_metrics.hpp"
#include "jitter.hpp"

namespace weft::evaluation {
namespace {

constexpr double kMmPerM = 1000.0;

double largest(const std::vector<double>& values) { return percentile(values, 100.0); }

double mean_of(const std::vector<double>& values) {
  return values.empty() ? kUnknown : mean(values);
}

ErrorSummary summarise(const std::vector<const FrameMetrics*>& frames, Outcome outcome) {
  ErrorSummary summary;
  std::vector<double> means, worst_points;
  for (const FrameMetrics* frame : frames) {
    if (frame->outcome != outcome || !frame->error) continue;
    if (means.empty() || frame->error->mean_mm > largest(means)) {
      summary.worst_frame = frame->label();
    }
    means.push_back(frame->error->mean_mm);
    worst_points.push_back(frame->error->worst_mm);
  }
  summary.frames = static_cast<std::int64_t>(means.size());
  summary.mean_mm = mean_of(means);
  summary.median_mm = median(means);
  summary.p95_mm = percentile(means, 95.0);
  summary.worst_mm = largest(means);
  summary.worst_point_mm = largest(worst_points);
  if (means.size() < 2) return summary;
  double squares = 0.0;
  for (const double value : means) squares += std::pow(value - summary.mean_mm, 2);
  const auto count = static_cast<double>(means.size());
  summary.standard_error_mm = std::sqrt(squares / (count - 1.0) / count);
  return summary;
}

GroupMetrics summarise_group(const std::vector<const FrameMetrics*>& frames, double off_mm) {
  GroupMetrics group;
  std::vector<double> strains;
  for (const FrameMetrics* frame : frames) {
    ++group.frames;
    group.solved += frame->outcome == Outcome::solved;
    group.held += frame->outcome == Outcome::held;
    group.missing += frame->outcome == Outcome::missing;
    group.invalid += frame->outcome == Outcome::invalid;
    group.points += frame->points;
    group.extrapolated += frame->extrapolated;
    group.unlocated += frame->unlocated;
    const bool has_shape = frame->outcome == Outcome::solved || frame->outcome == Outcome::held;
    group.unmeasured += has_shape && !frame->error;
    if (frame->outcome != Outcome::solved) continue;
    group.off += frame->error && frame->error->mean_mm > off_mm;
    strains.push_back(frame->strain_mean);
  }
  group.solved_error = summarise(frames, Outcome::solved);
  group.held_error = summarise(frames, Outcome::held);
  group.strain_mean = mean_of(strains);
  return group;
}

void count_frames(RunMetrics& metrics) {
  FrameCounts& counts = metrics.counts;
  std::vector<double> strains;
  for (const FrameMetrics& frame : metrics.frames) {
    ++counts.frames;
    counts.failed += frame.failed;
    if (frame.outcome == Outcome::solved) strains.push_back(frame.strain_mean);
    if (frame.outcome == Outcome::invalid) {
      ++counts.invalid;
      continue;
    }
    counts.estimated += frame.state == ShapeState::estimated;
    counts.weak += frame.state == ShapeState::weak;
    counts.predicted += frame.state == ShapeState::predicted;
    counts.lost += frame.state == ShapeState::lost;
    counts.none += frame.state == ShapeState::none;
  }
  metrics.strain_mean = mean_of(strains);
}

void summarise_image(double match_tolerance_px, RunMetrics& metrics) {
  std::vector<double> reprojection, overlay, truth_map;
  const auto add = [](double value, std::vector<double>& values) {
    if (std::isfinite(value)) values.push_back(value);
  };
  for (const FrameMetrics& frame : metrics.frames) {
    if (!frame.apart.empty()) continue;
    add(frame.image.reprojection_px, reprojection);
    add(frame.image.overlay_px, overlay);
    add(frame.image.truth_map_px, truth_map);
  }
  metrics.image = {match_tolerance_px,
                   static_cast<std::int64_t>(reprojection.size()),
                   static_cast<std::int64_t>(overlay.size()),
                   mean_of(reprojection),
                   mean_of(overlay),
                   truth_map.empty() ? kUnknown : median(truth_map)};
}

void summarise_filters(RunMetrics& metrics) {
  std::vector<std::string> stages;
  std::map<std::string, std::vector<FilterCounts>> counts;
  for (const FrameMetrics& frame : metrics.frames) {
    if (!frame.apart.empty()) continue;
    for (const auto& [stage, each] : frame.filters) {
      if (counts.count(stage) == 0) stages.push_back(stage);
      counts[stage].push_back(each);
    }
  }
  for (const std::string& stage : stages) {
    metrics.filters.push_back(summarise_filter(stage, counts[stage]));
  }
}

void group_frames(double off_mm, RunMetrics& metrics) {
  std::map<std::pair<std::string, std::string>, std::vector<const FrameMetrics*>> groups;
  std::vector<const FrameMetrics*> all;
  for (const FrameMetrics& frame : metrics.frames) {
    if (!frame.has_truth) continue;
    groups[{frame.apart, frame.kind}].push_back(&frame);
    if (frame.apart.empty()) all.push_back(&frame);
  }
  for (const auto& [key, frames] : groups) {
    metrics.groups.push_back(summarise_group(frames, off_mm));
    metrics.groups.back().apart = key.first;
    metrics.groups.back().kind = key.second;
  }
  metrics.all = summarise_group(all, off_mm);
}

std::string name_of(const std::string& folder) {
  const auto path = std::filesystem::absolute(folder).lexically_normal();
  return (path.has_filename() ? path : path.parent_path()).filename().string();
}

}  // namespace

const char* to_string(Outcome outcome) {
  constexpr const char* kNames[] = {"solved", "held", "missing", "invalid"};
  return kNames[static_cast<int>(outcome)];
}

Result<RunMetrics> evaluate_run(const std::string& folder, const EvaluationOptions& options) {
  const auto reader = RunReader::open(folder);
  if (!reader) return reader.error();
  const auto meter = ShapeMeter::create(reader->sheet());
  if (!meter) {
    return Error{meter.error().code, meter.error().message, folder + "/template.npz"};
  }
  RunMetrics metrics;
  metrics.run = name_of(folder);
  metrics.alignment = options.alignment;
  metrics.interrupted = reader->interrupted();
  metrics.truth_users = reader->truth_users();
  JitterMeter jitter;
  for (const FrameLine& line : reader->lines()) {
    const auto records = reader->read(line);
    if (!records) return records.error();
    auto frame = evaluate_frame(*reader, *meter, line, *records, options);
    if (!frame) return frame.error();
    jitter.add(*frame, *records);
    metrics.frames.push_back(*std::move(frame));
  }
  metrics.jitter = jitter.result();
  summarise_image(options.match_tolerance_px, metrics);
  summarise_filters(metrics);
  count_frames(metrics);
  group_frames(kOffShare * kMmPerM * meter->diagonal_m(), metrics);
  return metrics;
}

}  // namespace weft::evaluation
