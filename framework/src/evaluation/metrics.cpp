// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <weft/core/statistics.hpp>
#include <weft/evaluation/metrics.hpp>
#include <weft/evaluation/run_reader.hpp>
#include <weft/evaluation/shape_meter.hpp>

namespace weft::evaluation {
namespace {

constexpr double kMmPerM = 1000.0;

double largest(const std::vector<double>& values) { return percentile(values, 100.0); }

double mean_of(const std::vector<double>& values) {
  return values.empty() ? kUnknown : mean(values);
}

PointSummary summarise(const PointErrors& errors) {
  std::vector<double> mm;
  for (const double distance_m : errors.distances_m) mm.push_back(kMmPerM * distance_m);
  const auto worst = std::max_element(mm.begin(), mm.end());
  const std::int64_t point = errors.points[static_cast<std::size_t>(worst - mm.begin())];
  return {mean(mm), median(mm), percentile(mm, 95.0), *worst, point};
}

Outcome outcome_of(const FrameRecords& records) {
  if (!records.shape) return Outcome::missing;
  if (!std::isfinite(records.shape->vertices_m.matrix<3>().squaredNorm())) return Outcome::invalid;
  const ShapeState state = records.shape->shape_state();
  const bool solved = state == ShapeState::estimated || state == ShapeState::weak;
  return solved ? Outcome::solved : Outcome::held;
}

/// Compares a finite shape with the truth.
Result<void> measure_error(const ShapeMeter& meter, const FrameRecords& records,
                           Alignment alignment, FrameMetrics& frame) {
  const auto errors =
      meter.errors(records.shape->vertices_m.matrix<3>(), *records.ground_truth, alignment);
  if (!errors && errors.error().code != Errc::no_result) {
    return Error{errors.error().code, errors.error().message, "template.npz"};
  }
  if (!errors) {
    frame.no_error_because = errors.error().message;
    return {};
  }
  frame.extrapolated = errors->extrapolated;
  frame.unlocated = errors->unlocated;
  if (errors->distances_m.empty()) {
    frame.no_error_because = "no point of the truth lies on the template's mesh";
  } else {
    frame.error = summarise(*errors);
  }
  return {};
}

Result<FrameMetrics> evaluate_frame(const RunReader& reader, const ShapeMeter& meter,
                                    const FrameLine& line, Alignment alignment) {
  const auto records = reader.read(line);
  if (!records) return records.error();
  FrameMetrics frame;
  frame.frame = line.frame;
  frame.stem = line.stem;
  frame.state = line.state;
  frame.failed = line.failed;
  frame.outcome = outcome_of(*records);
  frame.has_truth = records->ground_truth.has_value();
  if (frame.has_truth) {
    frame.kind = records->ground_truth->kind;
    frame.apart = records->ground_truth->apart;
    frame.points = records->ground_truth->count();
  }
  if (frame.outcome == Outcome::missing || frame.outcome == Outcome::invalid) {
    const bool missing = frame.outcome == Outcome::missing;
    if (frame.has_truth) frame.no_error_because = missing ? "no shape" : "the shape is not finite";
    return frame;
  }
  const StrainStatistics strain = meter.strain(records->shape->vertices_m.matrix<3>());
  frame.strain_mean = strain.mean;
  frame.strain_p95 = strain.p95;
  if (frame.has_truth) {
    if (auto done = measure_error(meter, *records, alignment, frame); !done) return done.error();
  }
  return frame;
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
  for (const FrameLine& line : reader->lines()) {
    auto frame = evaluate_frame(*reader, *meter, line, options.alignment);
    if (!frame) return frame.error();
    metrics.frames.push_back(*std::move(frame));
  }
  count_frames(metrics);
  group_frames(kOffShare * kMmPerM * meter->diagonal_m(), metrics);
  return metrics;
}

}  // namespace weft::evaluation
