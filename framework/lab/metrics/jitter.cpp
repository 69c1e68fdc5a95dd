// SPDX-License-Identifier: Apache-2.0
#include "lab/metrics/jitter.hpp"

#include <algorithm>
#include <cmath>
#include <weft/core/statistics.hpp>
#include <weft/data/matrix.hpp>

#include "lab/metrics/field.hpp"

namespace weft::lab {
namespace {

constexpr double kJumpInSteps = 5.0;
constexpr double kJumpShare = 0.01;  // share of the diagonal: the steps of a surface at rest are
                                     // noise only

/// Mean |c - 2 b + a| of points [N,3] m; unknown where there are none.
double second_difference_mm(const Points3& a, const Points3& b, const Points3& c) {
  if (a.rows() == 0 || b.rows() == 0 || c.rows() == 0) return kUnknown;
  return kMmPerM * (c - 2.0 * b + a).rowwise().norm().mean();
}

}  // namespace

MotionMetrics MotionMeter::add(const FrameMetrics& frame, const FrameRecords& records) {
  if (!moments_.empty() && moments_.back().frame + 1 != frame.frame) moments_.clear();
  Moment now{frame.frame, {}, {}, {}};
  if (frame.outcome == FrameOutcome::solved) now.vertices_m = records.shape->vertices_m.matrix<3>();
  if (frame.has_truth) {
    now.truth_xy_m = records.ground_truth->template_xy_m.matrix<2>();
    now.truth_m = records.ground_truth->points_m.matrix<3>();
  }
  moments_.push_back(std::move(now));
  if (moments_.size() > 3) moments_.pop_front();
  const auto same_points = [](const Moment& a, const Moment& b) {
    return a.truth_xy_m.rows() > 0 && a.truth_xy_m.rows() == b.truth_xy_m.rows() &&
           a.truth_xy_m == b.truth_xy_m;
  };
  MotionMetrics motion;
  if (moments_.size() < 2) return motion;
  const Moment &b = *(moments_.end() - 2), &c = moments_.back();
  const bool step = same_points(b, c);
  if (step) motion.truth_step_mm = kMmPerM * (c.truth_m - b.truth_m).rowwise().norm().mean();
  if (moments_.size() < 3) return motion;
  const Moment& a = moments_.front();
  motion.jitter_mm = second_difference_mm(a.vertices_m, b.vertices_m, c.vertices_m);
  if (step && same_points(a, b) && std::isfinite(motion.jitter_mm)) {
    motion.truth_jitter_mm = second_difference_mm(a.truth_m, b.truth_m, c.truth_m);
  }
  return motion;
}

void mark_cuts(double diagonal_mm, std::vector<FrameMetrics>& frames) {
  std::vector<double> steps_mm;
  for (const FrameMetrics& frame : frames) {
    if (std::isfinite(frame.motion.truth_step_mm)) steps_mm.push_back(frame.motion.truth_step_mm);
  }
  if (steps_mm.empty()) return;
  const double jump_mm = std::max(kJumpShare * diagonal_mm, kJumpInSteps * median(steps_mm));
  const auto drop = [](MotionMetrics& motion) {
    motion.jitter_mm = motion.truth_jitter_mm = kUnknown;
  };
  for (std::size_t i = 0; i < frames.size(); ++i) {
    frames[i].motion.cut = frames[i].motion.truth_step_mm > jump_mm;
    if (!frames[i].motion.cut) continue;
    drop(frames[i].motion);
    if (i + 1 < frames.size()) drop(frames[i + 1].motion);
  }
}

Jitter summarise_jitter(const std::vector<FrameMetrics>& frames) {
  Jitter jitter;
  std::vector<double> shape_mm, truth_mm;
  for (const FrameMetrics& frame : frames) {
    jitter.cuts += frame.motion.cut;
    if (std::isfinite(frame.motion.jitter_mm)) shape_mm.push_back(frame.motion.jitter_mm);
    if (std::isfinite(frame.motion.truth_jitter_mm)) {
      truth_mm.push_back(frame.motion.truth_jitter_mm);
    }
  }
  jitter.triples = static_cast<std::int64_t>(shape_mm.size());
  jitter.truth_triples = static_cast<std::int64_t>(truth_mm.size());
  jitter.median_mm = median(shape_mm);
  jitter.mean_mm = mean(shape_mm);
  jitter.truth_mean_mm = mean(truth_mm);
  return jitter;
}

}  // namespace weft::lab
