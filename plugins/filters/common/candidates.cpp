// SPDX-License-Identifier: Apache-2.0
#include "common/candidates.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <tuple>

namespace weft::filters {

Result<Candidates> candidates_of(const Correspondences& correspondences) {
  Candidates found;
  for (std::int64_t i = 0; i < correspondences.count(); ++i) {
    if (correspondences.kept(i) == 0) continue;
    for (const double coordinate :
         {correspondences.template_px(i, 0), correspondences.template_px(i, 1),
          correspondences.image_px(i, 0), correspondences.image_px(i, 1)}) {
      if (std::isfinite(coordinate)) continue;
      return Error{Errc::invalid_data,
                   "match " + std::to_string(i) + " has a coordinate that is not finite",
                   {}};
    }
    found.matches.push_back(i);
  }
  const auto place = [&](std::int64_t i) {
    return std::tuple(correspondences.template_px(i, 0), correspondences.template_px(i, 1),
                      correspondences.image_px(i, 0), correspondences.image_px(i, 1), i);
  };
  std::sort(found.matches.begin(), found.matches.end(),
            [&](std::int64_t i, std::int64_t j) { return place(i) < place(j); });
  const auto count = static_cast<Eigen::Index>(found.count());
  found.template_px.resize(count, 2);
  found.image_px.resize(count, 2);
  for (Eigen::Index k = 0; k < count; ++k) {
    const std::int64_t i = found.matches[static_cast<std::size_t>(k)];
    found.template_px.row(k) << correspondences.template_px(i, 0),
        correspondences.template_px(i, 1);
    found.image_px.row(k) << correspondences.image_px(i, 0), correspondences.image_px(i, 1);
  }
  return found;
}

InlierMask mask_of(const Correspondences& correspondences, const Candidates& candidates,
                   std::span<const std::uint8_t> keep, std::span<const double> score) {
  const std::int64_t count = correspondences.count();
  InlierMask mask;
  mask.kept = Array<std::uint8_t>({count});
  mask.score = Array<double>({count});
  std::fill_n(mask.kept.data(), count, std::uint8_t{0});
  std::fill_n(mask.score.data(), count, 0.0);
  for (std::size_t k = 0; k < candidates.count(); ++k) {
    mask.kept(candidates.matches[k]) = keep[k];
    mask.score(candidates.matches[k]) = score[k];
  }
  mask.diag.set("candidates", static_cast<double>(candidates.count()));
  return mask;
}

Normaliser::Normaliser(const Points2& points_px) {
  if (points_px.rows() == 0) return;
  mean_px = points_px.colwise().mean();
  const double norm_px = (points_px.rowwise() - mean_px).rowwise().norm().mean();
  per_px = norm_px > 0.0 ? std::numbers::sqrt2 / norm_px : 0.0;
}

}  // namespace weft::filters
