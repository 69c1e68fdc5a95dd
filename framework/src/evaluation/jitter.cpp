// SPDX-License-Identifier: Apache-2.0
#include "jitter.hpp"

#include <weft/core/statistics.hpp>

namespace weft::evaluation {
namespace {

constexpr double kMmPerM = 1000.0;

double second_difference_mm(const Points3& before, const Points3& middle, const Points3& after) {
  return kMmPerM * (after - 2.0 * middle + before).rowwise().norm().mean();
}

}  // namespace

void JitterMeter::add(const FrameMetrics& frame, const FrameRecords& records) {
  if (frame.outcome != Outcome::solved) return;
  if (!moments_.empty() && moments_.back().frame + 1 != frame.frame) moments_.clear();
  Moment now{frame.frame, records.shape->vertices_m.matrix<3>(), std::nullopt, {}};
  if (records.ground_truth && records.ground_truth->count() > 0) {
    now.truth_xy_m = records.ground_truth->template_xy_m.matrix<2>();
    now.truth_m = records.ground_truth->points_m.matrix<3>();
  }
  moments_.push_back(std::move(now));
  if (moments_.size() > 3) moments_.pop_front();
  if (moments_.size() < 3) return;
  const Moment &a = moments_[0], &b = moments_[1], &c = moments_[2];
  shape_mm_.push_back(second_difference_mm(a.vertices_m, b.vertices_m, c.vertices_m));
  const bool same_points = a.truth_xy_m && b.truth_xy_m && c.truth_xy_m &&
                           a.truth_xy_m->rows() == b.truth_xy_m->rows() &&
                           a.truth_xy_m->rows() == c.truth_xy_m->rows() &&
                           *a.truth_xy_m == *b.truth_xy_m && *a.truth_xy_m == *c.truth_xy_m;
  if (same_points) truth_mm_.push_back(second_difference_mm(a.truth_m, b.truth_m, c.truth_m));
}

Jitter JitterMeter::result() const {
  return {static_cast<std::int64_t>(shape_mm_.size()), static_cast<std::int64_t>(truth_mm_.size()),
          shape_mm_.empty() ? kUnknown : mean(shape_mm_),
          truth_mm_.empty() ? kUnknown : mean(truth_mm_)};
}

}  // namespace weft::evaluation
