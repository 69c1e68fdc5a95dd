// SPDX-License-Identifier: Apache-2.0
#include "common/candidates.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <tuple>
#include <weft/core/index.hpp>

namespace weft::filters {
namespace {

using Places = std::array<double, 4>;

Places places_of(const Correspondences& matches, std::int64_t i) {
  return {matches.template_px(i, 0), matches.template_px(i, 1), matches.image_px(i, 0),
          matches.image_px(i, 1)};
}

/// Sorts by place; within one place, those with the least ratio first.
void sort_by_place(const Correspondences& matches, std::vector<std::int64_t>& rows) {
  const auto or_zero = [](const Array<double>& values, std::int64_t i) {
    return values.present() ? values(i) : 0.0;
  };
  const auto key = [&](std::int64_t i) {
    return std::tuple(places_of(matches, i), or_zero(matches.ratio, i),
                      or_zero(matches.angle_difference_rad, i), or_zero(matches.scale_ratio, i), i);
  };
  std::sort(rows.begin(), rows.end(), [&](std::int64_t i, std::int64_t j) {
    const double u = matches.template_px(i, 0), other_u = matches.template_px(j, 0);
    return u != other_u ? u < other_u : key(i) < key(j);
  });
}

}  // namespace

Result<Candidates> candidates_of(const Correspondences& correspondences) {
  std::vector<std::int64_t> rows;
  for (std::int64_t i = 0; i < correspondences.count(); ++i) {
    if (correspondences.kept(i) == 0) continue;
    for (const double coordinate : places_of(correspondences, i)) {
      if (std::isfinite(coordinate)) continue;
      return Error{Errc::invalid_data,
                   "match " + std::to_string(i) + " has a coordinate that is not finite"};
    }
    rows.push_back(i);
  }
  sort_by_place(correspondences, rows);
  Candidates found;
  for (const std::int64_t i : rows) {
    if (!found.matches.empty() &&
        places_of(correspondences, found.matches.back()) == places_of(correspondences, i)) {
      found.copies.push_back({i, found.count() - 1});
    } else {
      found.matches.push_back(i);
    }
  }
  const auto count = static_cast<Eigen::Index>(found.count());
  found.template_px.resize(count, 2);
  found.image_px.resize(count, 2);
  for (Eigen::Index k = 0; k < count; ++k) {
    const Places places = places_of(correspondences, found.matches[to_index(k)]);
    found.template_px.row(k) << places[0], places[1];
    found.image_px.row(k) << places[2], places[3];
  }
  return found;
}

InlierMask mask_of(const Correspondences& correspondences, const Candidates& candidates,
                   std::span<const std::uint8_t> keep, std::span<const double> score) {
  const std::int64_t count = correspondences.count();
  InlierMask mask;
  mask.kept = Array<std::uint8_t>({count}, 0);
  mask.score = Array<double>({count}, 0.0);
  const auto judge = [&](std::int64_t match, std::size_t k) {
    mask.kept(match) = keep[k];
    mask.score(match) = score[k];
  };
  for (std::size_t k = 0; k < candidates.count(); ++k) judge(candidates.matches[k], k);
  for (const auto& copy : candidates.copies) judge(copy.match, copy.candidate);
  mask.diag.set("candidates", static_cast<double>(candidates.count() + candidates.copies.size()));
  mask.diag.set("kept_matches", static_cast<double>(std::count(
                                    mask.kept.data(), mask.kept.data() + count, std::uint8_t{1})));
  return mask;
}

Result<PictureSizes> sizes_of(const FilterInput& in) {
  if (!in.templ || !in.camera) {
    return Error{Errc::invalid_data, "template and camera are needed: connect both"};
  }
  PictureSizes sizes;
  sizes.template_px << static_cast<double>(in.templ->texture.dim(1)),
      static_cast<double>(in.templ->texture.dim(0));
  sizes.image_px << static_cast<double>(in.camera->width_px),
      static_cast<double>(in.camera->height_px);
  return sizes;
}

Normaliser::Normaliser(const Points2& points_px) {
  if (points_px.rows() == 0) return;
  mean_px = points_px.colwise().mean();
  const double norm_px = (points_px.rowwise() - mean_px).rowwise().norm().mean();
  per_px = norm_px > 0.0 ? std::numbers::sqrt2 / norm_px : 0.0;
}

}  // namespace weft::filters
