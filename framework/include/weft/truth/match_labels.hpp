// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <limits>
#include <optional>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/data/correspondences.hpp>
#include <weft/data/matrix.hpp>
#include <weft/data/template.hpp>
#include <weft/geometry/camera_model.hpp>
#include <weft/truth/truth_map.hpp>

namespace weft {

/// Labels of matches by ground truth.
inline constexpr std::int8_t kUnknownMatch = -1, kMismatch = 0, kCorrectMatch = 1;

/// Returns whether the truth has an entry for each match. This is the case for matches of the
/// source itself, unless a stage changed their number.
inline bool has_own_truth(const Correspondences& matches, const TruthMap& truth) {
  const auto entries =
      std::max<std::int64_t>(truth.match_xy_px().rows(), std::ssize(truth.match_labels()));
  return entries > 0 && entries == matches.count() && !matches.image_keypoint.present();
}

namespace detail {

/// Label of the source's match n: by the distance from its true image, else the label that the
/// source gave.
inline std::int8_t own_label(const Correspondences& matches, const TruthMap& truth, std::int64_t n,
                             double tolerance_px) {
  if (n < truth.match_xy_px().rows() && truth.match_xy_px().row(n).allFinite()) {
    const Eigen::RowVector2d image_px = matches.image_px.matrix<2>().row(n);
    const double distance_px = (truth.match_xy_px().row(n) - image_px).norm();
    if (!(distance_px >= 0.0)) return kUnknownMatch;
    return distance_px < tolerance_px ? kCorrectMatch : kMismatch;
  }
  if (n >= std::ssize(truth.match_labels())) return kUnknownMatch;
  const std::int8_t given = truth.match_labels()[to_index(n)];
  return given == kCorrectMatch || given == kMismatch ? given : kUnknownMatch;
}

}  // namespace detail

/// One label per match (p, q): inlier if |W(p) - q| < tolerance_px, where W(p) is the true image of
/// p. For the source's matches, W(p) comes from their truth, or else the given label applies. For
/// other matches, W(p) is the projection of the true position of p. A match of a hidden point is an
/// outlier. A match beside the truth, with non-finite values or of a template without m_per_px is
/// unknown.
inline std::vector<std::int8_t> label_matches(const Correspondences& matches, const TruthMap& truth,
                                              const Template& templ, const Pinhole& camera,
                                              double tolerance_px) {
  const bool own = has_own_truth(matches, truth);
  Eigen::Vector2d m_per_px = Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
  if (templ.m_per_px.present()) m_per_px = templ.m_per_px.matrix<1>();
  const auto label = [&](std::int64_t n) {
    const Eigen::Vector2d template_px = matches.template_px.matrix<2>().row(n);
    const Eigen::Vector2d image_px = matches.image_px.matrix<2>().row(n);
    if (own) return detail::own_label(matches, truth, n, tolerance_px);
    const auto place = truth.at(template_px.cwiseProduct(m_per_px));
    if (!place) return kUnknownMatch;
    if (place->hidden) return kMismatch;
    const double distance_px = (project(camera, place->point_m) - image_px).norm();
    if (!(distance_px >= 0.0)) return kUnknownMatch;
    return distance_px < tolerance_px ? kCorrectMatch : kMismatch;
  };
  std::vector<std::int8_t> labels;
  for (std::int64_t n = 0; n < matches.count(); ++n) {
    worked(100);
    labels.push_back(label(n));
  }
  return labels;
}

}  // namespace weft
