// SPDX-License-Identifier: Apache-2.0
#include "lab/metrics/visibility_metrics.hpp"

#include <weft/data/matrix.hpp>
#include <weft/truth/truth_map.hpp>

#include "lab/metrics/field.hpp"
#include "lab/metrics/shapes/shape_meter.hpp"

namespace weft::lab {
namespace {

double ratio(double part, std::int64_t whole) {
  return whole > 0 ? part / static_cast<double>(whole) : kUnknown;
}

double share_percent(std::int64_t part, std::int64_t whole) {
  return kPercent * ratio(static_cast<double>(part), whole);
}

}  // namespace

void count_vertices(const Visibility& said, const Template& sheet, const TruthMap& truth,
                    VisibilityCounts& counts) {
  if (!sheet.m_per_px.present()) return;
  const Eigen::Vector2d m_per_px = sheet.m_per_px.matrix<1>();
  for (std::int64_t v = 0; v < said.visible.rows(); ++v) {
    const Eigen::Vector2d flat_px = sheet.flat_px.matrix<2>().row(v);
    const auto place = truth.at(flat_px.cwiseProduct(m_per_px));
    if (!place) continue;
    const bool seen = said.visible(v) != 0;
    if (seen) ++(place->hidden ? counts.seen_wrong : counts.seen_right);
    if (!seen) ++(place->hidden ? counts.hidden_right : counts.hidden_wrong);
  }
}

void count_errors(const PointErrors& errors, const Array<std::uint8_t>& visible,
                  VisibilityCounts& counts) {
  for (std::size_t i = 0; i < errors.points.size(); ++i) {
    const bool seen = visible(errors.points[i]) != 0;
    ++(seen ? counts.visible_points : counts.hidden_points);
    (seen ? counts.visible_sum_mm : counts.hidden_sum_mm) += kMmPerM * errors.distances_m[i];
  }
}

VisibilityMetrics summarise_visibility(const std::vector<VisibilityCounts>& frames) {
  VisibilityCounts sum;
  for (const VisibilityCounts& frame : frames) {
    sum.seen_right += frame.seen_right;
    sum.seen_wrong += frame.seen_wrong;
    sum.hidden_right += frame.hidden_right;
    sum.hidden_wrong += frame.hidden_wrong;
    sum.visible_points += frame.visible_points;
    sum.hidden_points += frame.hidden_points;
    sum.visible_sum_mm += frame.visible_sum_mm;
    sum.hidden_sum_mm += frame.hidden_sum_mm;
  }
  const std::int64_t mistakes = sum.seen_wrong + sum.hidden_wrong;
  VisibilityMetrics metrics;
  metrics.frames = static_cast<std::int64_t>(frames.size());
  metrics.vertices = sum.vertices();
  metrics.hidden_vertices = sum.hidden_right + sum.seen_wrong;
  metrics.visible_points = sum.visible_points;
  metrics.hidden_points = sum.hidden_points;
  metrics.precision_percent = share_percent(sum.seen_right, sum.seen_right + sum.seen_wrong);
  metrics.recall_percent = share_percent(sum.seen_right, sum.seen_right + sum.hidden_wrong);
  metrics.f1_percent = share_percent(2 * sum.seen_right, 2 * sum.seen_right + mistakes);
  metrics.hidden_f1_percent = share_percent(2 * sum.hidden_right, 2 * sum.hidden_right + mistakes);
  metrics.visible_mm = ratio(sum.visible_sum_mm, sum.visible_points);
  metrics.hidden_mm = ratio(sum.hidden_sum_mm, sum.hidden_points);
  return metrics;
}

std::optional<VisibilityMetrics> visibility_of(const std::optional<VisibilityCounts>& frame) {
  if (!frame) return std::nullopt;
  return summarise_visibility(std::vector{*frame});
}

}  // namespace weft::lab
