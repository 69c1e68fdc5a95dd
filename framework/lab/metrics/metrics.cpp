// SPDX-License-Identifier: Apache-2.0
#include "lab/metrics/metrics.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <weft/core/statistics.hpp>

#include "lab/metrics/field.hpp"
#include "lab/metrics/frame_evaluation.hpp"
#include "lab/metrics/jitter.hpp"
#include "lab/metrics/runs/run_reader.hpp"
#include "lab/metrics/shapes/shape_meter.hpp"

namespace weft::lab {
namespace {

double largest(const std::vector<double>& values) { return percentile(values, 100.0); }

ErrorSummary summarise(const std::vector<const FrameMetrics*>& frames, FrameOutcome outcome) {
  ErrorSummary summary;
  std::vector<double> means, worst_points, of_depth;
  for (const FrameMetrics* frame : frames) {
    if (frame->outcome != outcome || !frame->error) continue;
    if (means.empty() || frame->error->mean_mm > largest(means)) {
      summary.worst_frame = frame->label();
    }
    means.push_back(frame->error->mean_mm);
    worst_points.push_back(frame->error->worst_mm);
    of_depth.push_back(frame->error->of_depth_percent);
  }
  summary.frames = static_cast<std::int64_t>(means.size());
  summary.mean_mm = mean_or_unknown(means);
  summary.median_mm = median(means);
  summary.p95_mm = percentile(means, 95.0);
  summary.worst_mm = largest(means);
  summary.worst_point_mm = largest(worst_points);
  summary.of_depth_percent = mean_or_unknown(of_depth);
  if (means.size() < 2) return summary;
  double squares = 0.0;
  for (const double value : means) squares += std::pow(value - summary.mean_mm, 2);
  const auto count = static_cast<double>(means.size());
  summary.standard_error_mm = std::sqrt(squares / (count - 1.0) / count);
  return summary;
}

TruthMetrics summarise_group(const std::vector<const FrameMetrics*>& frames, double off_mm) {
  TruthMetrics group;
  std::vector<double> strains, strains_p95;
  for (const FrameMetrics* frame : frames) {
    ++group.frames;
    group.solved += frame->outcome == FrameOutcome::solved;
    group.carried_over += frame->outcome == FrameOutcome::carried_over;
    group.missing += frame->outcome == FrameOutcome::missing;
    group.invalid += frame->outcome == FrameOutcome::invalid;
    group.points += frame->points;
    group.extrapolated += frame->extrapolated;
    group.unlocated += frame->unlocated;
    const bool has_shape =
        frame->outcome == FrameOutcome::solved || frame->outcome == FrameOutcome::carried_over;
    group.unmeasured += has_shape && !frame->error && frame->points > 0;
    group.off += frame->error && frame->error->mean_mm > off_mm;
    if (frame->outcome != FrameOutcome::solved) continue;
    strains.push_back(frame->strain_mean);
    strains_p95.push_back(frame->strain_p95);
  }
  group.solved_error = summarise(frames, FrameOutcome::solved);
  group.carried_over_error = summarise(frames, FrameOutcome::carried_over);
  group.strain_mean = mean_or_unknown(strains);
  group.strain_p95 = mean_or_unknown(strains_p95);
  return group;
}

void count_frames(RunMetrics& metrics) {
  FrameCounts& counts = metrics.counts;
  std::vector<double> strains, strains_p95;
  for (const FrameMetrics& frame : metrics.frames) {
    ++counts.frames;
    counts.failed += frame.failed;
    if (frame.outcome == FrameOutcome::solved) {
      strains.push_back(frame.strain_mean);
      strains_p95.push_back(frame.strain_p95);
    }
    if (frame.outcome == FrameOutcome::invalid) {
      ++counts.invalid;
      continue;
    }
    counts.estimated += frame.state == ShapeState::estimated;
    counts.weak += frame.state == ShapeState::weak;
    counts.predicted += frame.state == ShapeState::predicted;
    counts.lost += frame.state == ShapeState::lost;
    counts.none += frame.state == ShapeState::none;
  }
  metrics.strain_mean = mean_or_unknown(strains);
  metrics.strain_p95 = mean_or_unknown(strains_p95);
}

void summarise_image(double match_tolerance_px, RunMetrics& metrics) {
  ImageSummary& image = metrics.image;
  std::vector<double> reprojection, overlay, truth_map;
  const auto add = [](double value, std::vector<double>& values) {
    if (std::isfinite(value)) values.push_back(value);
  };
  for (const FrameMetrics& frame : metrics.frames) {
    if (!frame.exclusion.empty()) continue;
    add(frame.image.reprojection_px, reprojection);
    add(frame.image.overlay_px, overlay);
    add(frame.image.truth_map_px, truth_map);
    image.reprojection_matches += frame.image.reprojection_matches;
    image.overlay_vertices += frame.image.overlay_vertices;
    image.behind_camera_frames += frame.image.behind_camera;
  }
  image.match_tolerance_px = match_tolerance_px;
  image.reprojection_frames = static_cast<std::int64_t>(reprojection.size());
  image.overlay_frames = static_cast<std::int64_t>(overlay.size());
  image.reprojection_px = mean_or_unknown(reprojection);
  image.overlay_px = mean_or_unknown(overlay);
  image.truth_map_px = median(truth_map);
}

void summarise_depth(RunMetrics& metrics) {
  DepthSummary& depth = metrics.depth;
  std::vector<double> medians_mm;
  for (const FrameMetrics& frame : metrics.frames) {
    if (!frame.depth || !frame.exclusion.empty()) continue;
    depth.matches += frame.depth->matches;
    depth.without_depth += frame.depth->without_depth;
    if (frame.depth->matches == 0) ++depth.frames_without_median;
    if (frame.depth->matches > 0) medians_mm.push_back(frame.depth->median_mm);
  }
  depth.frames = static_cast<std::int64_t>(medians_mm.size());
  depth.mean_mm = mean_or_unknown(medians_mm);
  depth.median_mm = median(medians_mm);
  depth.worst_mm = largest(medians_mm);
}

void add_surfaces(RunMetrics& metrics) {
  std::vector<SurfaceMetrics> frames;
  for (const FrameMetrics& frame : metrics.frames) {
    if (frame.surface && frame.exclusion.empty()) frames.push_back(*frame.surface);
  }
  metrics.surface = summarise_surfaces(frames);
}

void add_visibility(RunMetrics& metrics) {
  std::vector<VisibilityCounts> counts;
  for (const FrameMetrics& frame : metrics.frames) {
    if (frame.visibility && frame.exclusion.empty()) counts.push_back(*frame.visibility);
  }
  metrics.visibility = summarise_visibility(counts);
}

void add_registration(RunMetrics& metrics) {
  std::vector<FrameRegistration> frames;
  std::int64_t all_frames = 0;
  for (const FrameMetrics& frame : metrics.frames) {
    if (!frame.exclusion.empty()) continue;
    ++all_frames;
    if (frame.registration) frames.push_back(*frame.registration);
  }
  metrics.registration = summarise_registration(frames, all_frames);
}

void add_certainty(RunMetrics& metrics) {
  std::vector<FrameCertainty> frames;
  for (const FrameMetrics& frame : metrics.frames) {
    if (frame.certainty && frame.exclusion.empty()) frames.push_back(*frame.certainty);
  }
  metrics.certainty = summarise_certainty(frames);
}

/// For each stage or part, the metrics `member` of the frames whose truth counts, in the order of
/// first occurrence.
template <class Metrics>
std::vector<std::pair<std::string, std::vector<Metrics>>> by_name(
    const std::vector<FrameMetrics>& frames,
    std::vector<std::pair<std::string, Metrics>> FrameMetrics::*member) {
  std::vector<std::pair<std::string, std::vector<Metrics>>> all;
  for (const FrameMetrics& frame : frames) {
    if (!frame.exclusion.empty()) continue;
    for (const auto& [name, each] : frame.*member) {
      auto known = std::find_if(all.begin(), all.end(), [&named = name](const auto& entry) {
        return entry.first == named;
      });
      if (known == all.end()) known = all.insert(known, {name, {}});
      known->second.push_back(each);
    }
  }
  return all;
}

void summarise_named(RunMetrics& metrics) {
  for (const auto& [stage, counts] : by_name(metrics.frames, &FrameMetrics::filters)) {
    metrics.filters.push_back(summarise_filter(stage, counts));
  }
  for (const auto& [stage, errors] : by_name(metrics.frames, &FrameMetrics::warps)) {
    metrics.warps.push_back(summarise_warp(stage, errors));
  }
  metrics.parts = summarise_parts(by_name(metrics.frames, &FrameMetrics::parts));
}

void group_frames(double off_mm, RunMetrics& metrics) {
  std::map<std::pair<std::string, std::string>, std::vector<const FrameMetrics*>> groups;
  std::vector<const FrameMetrics*> all;
  for (const FrameMetrics& frame : metrics.frames) {
    if (!frame.has_truth) continue;
    groups[{frame.exclusion, frame.kind}].push_back(&frame);
    if (frame.exclusion.empty()) all.push_back(&frame);
  }
  for (const auto& [key, frames] : groups) {
    metrics.groups.push_back({summarise_group(frames, off_mm), key.second, key.first});
  }
  metrics.all = summarise_group(all, off_mm);
}

/// The first error, with how many files have one.
Error damage_of(const std::vector<Error>& errors, std::size_t frames) {
  Error first = errors.front();
  if (errors.size() == 1) return first;
  first.message += "; " + std::to_string(errors.size()) + " of " + std::to_string(frames) +
                   " frames are damaged, the last one in " + errors.back().where;
  return first;
}

std::string name_of(const std::string& folder) {
  const auto path = std::filesystem::absolute(folder).lexically_normal();
  return (path.has_filename() ? path : path.parent_path()).filename().string();
}

}  // namespace

const char* to_string(FrameOutcome outcome) {
  constexpr const char* kNames[] = {"solved", "carried_over", "missing", "invalid"};
  return kNames[static_cast<int>(outcome)];
}

struct RunEvaluator::State {
  const RunReader& scene;
  ShapeMeter meter;
  EvaluationOptions options;
  bool is_sequence;
  MotionMeter motion{};
  std::vector<FrameMetrics> frames{};
};

RunEvaluator::RunEvaluator(std::unique_ptr<State> state) : state_(std::move(state)) {}
RunEvaluator::RunEvaluator(RunEvaluator&& other) noexcept = default;
RunEvaluator& RunEvaluator::operator=(RunEvaluator&& other) noexcept = default;
RunEvaluator::~RunEvaluator() = default;

Result<RunEvaluator> RunEvaluator::create(const RunReader& scene, const EvaluationOptions& options,
                                          bool is_sequence) {
  auto meter = ShapeMeter::create(scene.sheet());
  if (!meter) return meter.error();
  return RunEvaluator(
      std::unique_ptr<State>(new State{scene, *std::move(meter), options, is_sequence}));
}

Result<void> RunEvaluator::add(const FrameLine& line, const FrameRecords& records) {
  auto frame = evaluate_frame(state_->scene, state_->meter, line, records, state_->options);
  if (!frame) return frame.error();
  if (state_->is_sequence) frame->motion = state_->motion.add(*frame, records);
  state_->frames.push_back(*std::move(frame));
  return {};
}

const std::vector<FrameMetrics>& RunEvaluator::frames() const { return state_->frames; }

RunMetrics RunEvaluator::finish(bool has_solver) {
  RunMetrics metrics;
  metrics.alignment = state_->options.alignment;
  metrics.frames = std::move(state_->frames);
  mark_cuts(kMmPerM * state_->meter.diagonal_m(), metrics.frames);
  metrics.jitter = summarise_jitter(metrics.frames);
  summarise_image(state_->options.match_tolerance_px, metrics);
  summarise_depth(metrics);
  add_surfaces(metrics);
  add_visibility(metrics);
  add_registration(metrics);
  add_certainty(metrics);
  summarise_named(metrics);
  count_frames(metrics);
  metrics.has_solver = has_solver;
  if (has_solver) {
    group_frames(kOffShare * kMmPerM * state_->meter.diagonal_m(), metrics);
  }
  return metrics;
}

Result<RunMetrics> evaluate_run(const std::string& folder, const EvaluationOptions& options) {
  const auto reader = RunReader::open(folder);
  if (!reader) return reader.error();
  auto evaluator = RunEvaluator::create(*reader, options, reader->is_sequence());
  if (!evaluator) {
    return Error{evaluator.error().code, evaluator.error().message, folder + "/template.npz"};
  }
  std::vector<Error> damages;
  std::vector<std::string> warnings = reader->warnings();
  for (const FrameLine& line : reader->lines()) {
    auto records = reader->read(line);
    const bool solved = line.state == ShapeState::estimated || line.state == ShapeState::weak;
    if (records && options.measure_registration && solved) {
      auto measured = options.measure_registration(line, *records);
      if (!measured) return measured.error();
      records->registration = *std::move(measured);
    }
    if (!records && reader->killed()) {
      // The rest had not been written to the disk when the run was cut off.
      warnings.push_back(records.error().where + ": " + records.error().message + "; frames from " +
                         std::to_string(line.frame) + " on are omitted");
      break;
    }
    if (!records) {
      damages.push_back(records.error());
    } else if (auto added = evaluator->add(line, *records); !added) {
      return added.error();
    }
  }
  if (!damages.empty()) return damage_of(damages, reader->lines().size());
  RunMetrics metrics = evaluator->finish(reader->has_solver());
  metrics.run = name_of(folder);
  metrics.interrupted = reader->interrupted();
  metrics.source_frames = reader->source_frames();
  metrics.dropped = reader->dropped();
  metrics.truth_users = reader->truth_users();
  metrics.implements = reader->implements();
  metrics.warnings = std::move(warnings);
  return metrics;
}

}  // namespace weft::lab
