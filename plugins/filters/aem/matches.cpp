// SPDX-License-Identifier: Apache-2.0
#include "matches.hpp"

#include <weft/core/index.hpp>

namespace weft::aem {
namespace {

/// Scales and angles of the candidates; nothing where one of them is not usable.
void add_orientation(const Correspondences& correspondences, const filters::Candidates& candidates,
                     Matches& matches) {
  const Eigen::Index n = matches.count();
  Eigen::ArrayXd log_scale(n), turn_rad(n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const std::int64_t i = candidates.matches[to_index(k)];
    log_scale[k] = std::log(correspondences.scale_ratio(i));
    turn_rad[k] = correspondences.angle_difference_rad(i);
  }
  if (!log_scale.allFinite() || !turn_rad.allFinite()) return;
  matches.log_scale = log_scale;
  matches.turn_rad = turn_rad;
}

}  // namespace

Matches matches_of(const Correspondences& correspondences, const filters::Candidates& candidates,
                   const Template& templ, bool use_orientation) {
  Matches matches;
  matches.template_px = candidates.template_px;
  matches.image_px = candidates.image_px;
  matches.box = object_box(templ);
  if (matches.count() > 0) {
    const Eigen::RowVector2d extent_px =
        matches.image_px.colwise().maxCoeff() - matches.image_px.colwise().minCoeff();
    matches.image_area_px2 = extent_px.prod();
  }
  if (use_orientation && correspondences.scale_ratio.present() &&
      correspondences.angle_difference_rad.present()) {
    add_orientation(correspondences, candidates, matches);
  }
  return matches;
}

}  // namespace weft::aem
