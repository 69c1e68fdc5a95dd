// SPDX-License-Identifier: Apache-2.0
#include "pipeline/monitor/rejected_matches.hpp"

#include <algorithm>
#include <utility>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/geometry/types.hpp>

namespace weft {
namespace {

constexpr std::size_t kNeighbours = 8, kShared = 3;
constexpr std::size_t kMostLookedAt = 2000;  // each is compared with each

/// The nearest of other rows; one of a distance below a pixel is the same keypoint once more.
std::vector<std::size_t> nearest(const Points2& places_px, std::size_t of) {
  std::vector<std::pair<double, std::size_t>> others;
  for (std::size_t i = 0; i < to_index(places_px.rows()); ++i) {
    const double square =
        (places_px.row(static_cast<Eigen::Index>(i)) - places_px.row(static_cast<Eigen::Index>(of)))
            .squaredNorm();
    if (square >= 1.0) others.emplace_back(square, i);
  }
  const std::size_t kept = std::min(kNeighbours, others.size());
  std::partial_sort(others.begin(), others.begin() + static_cast<std::ptrdiff_t>(kept),
                    others.end());
  std::vector<std::size_t> found;
  for (std::size_t k = 0; k < kept; ++k) found.push_back(others[k].second);
  return found;
}

bool is_coherent(const Points2& template_px, const Points2& image_px, std::size_t of) {
  const std::vector<std::size_t> here = nearest(template_px, of), there = nearest(image_px, of);
  const auto shared = std::count_if(here.begin(), here.end(), [&](std::size_t i) {
    return std::find(there.begin(), there.end(), i) != there.end();
  });
  return shared >= static_cast<std::ptrdiff_t>(kShared);
}

Points2 rows_of(const Array<double>& places_px, const std::vector<Eigen::Index>& rows) {
  return places_px.matrix<2>()(rows, Eigen::all);
}

}  // namespace

CoherentRejects coherent_rejects(const Correspondences& matches) {
  std::vector<Eigen::Index> kept, rejected;
  for (std::int64_t i = 0; i < matches.count(); ++i) {
    (matches.kept(i) != 0 ? kept : rejected).push_back(i);
  }
  const std::size_t stride = rejected.size() / kMostLookedAt + 1;
  std::vector<Eigen::Index> some;
  for (std::size_t i = 0; i < rejected.size(); i += stride) some.push_back(rejected[i]);
  CoherentRejects found;
  if (some.size() <= kNeighbours || kept.empty()) return found;
  const Points2 kept_px = rows_of(matches.template_px, kept);
  const Points2 template_px = rows_of(matches.template_px, some);
  const Points2 image_px = rows_of(matches.image_px, some);
  // What was kept reaches as far as a twelfth of what it covers.
  const double reach_px =
      (kept_px.colwise().maxCoeff() - kept_px.colwise().minCoeff()).norm() / 12.0;
  for (std::size_t i = 0; i < some.size(); ++i) {
    if (!is_coherent(template_px, image_px, i)) continue;
    found.count += static_cast<int>(stride);
    const auto place_px = template_px.row(static_cast<Eigen::Index>(i));
    const double nearest_px = (kept_px.rowwise() - place_px).rowwise().norm().minCoeff();
    found.elsewhere += nearest_px > reach_px ? static_cast<int>(stride) : 0;
  }
  return found;
}

}  // namespace weft
