// SPDX-License-Identifier: Apache-2.0
#include "pipeline/monitor/rejected_matches.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <weft/core/index.hpp>
#include <weft/data/matrix.hpp>

namespace weft {
namespace {

constexpr std::size_t kNeighbours = 8, kShared = 3;
constexpr std::int64_t kMostLookedAt = 2000;  // each is compared with each

Eigen::Vector2d place_in(const Array<double>& places_px, std::int64_t match) {
  return places_px.matrix<2>().row(match);
}

double diagonal_px(const std::vector<Eigen::Vector2d>& places_px) {
  Eigen::Vector2d low = places_px.front(), high = low;
  for (const Eigen::Vector2d& place : places_px) {
    low = low.cwiseMin(place);
    high = high.cwiseMax(place);
  }
  return (high - low).norm();
}

}  // namespace

struct RejectedMatches::Neighbours {
  std::array<std::size_t, kNeighbours> index;
  std::size_t count = 0;
};

/// The nearest of other places; one of a distance below a pixel is the same keypoint once more.
RejectedMatches::Neighbours RejectedMatches::nearest(const Places& places_px, std::size_t of) {
  others_.clear();
  for (std::size_t i = 0; i < places_px.size(); ++i) {
    const double square = (places_px[i] - places_px[of]).squaredNorm();
    if (square >= 1.0) others_.emplace_back(square, i);
  }
  Neighbours found;
  found.count = std::min(kNeighbours, others_.size());
  std::partial_sort(others_.begin(), others_.begin() + static_cast<std::ptrdiff_t>(found.count),
                    others_.end());
  for (std::size_t k = 0; k < found.count; ++k) found.index[k] = others_[k].second;
  return found;
}

bool RejectedMatches::is_coherent(std::size_t of) {
  const Neighbours here = nearest(template_px_, of), there = nearest(image_px_, of);
  const auto* there_end = there.index.begin() + there.count;
  const auto shared = std::count_if(
      here.index.begin(), here.index.begin() + here.count,
      [&](std::size_t i) { return std::find(there.index.begin(), there_end, i) != there_end; });
  return shared >= static_cast<std::ptrdiff_t>(kShared);
}

/// Takes the places of those that were kept, and of each `stride`th that was not.
void RejectedMatches::choose(const Correspondences& matches, std::int64_t stride) {
  kept_px_.clear();
  template_px_.clear();
  image_px_.clear();
  std::int64_t rejected = 0;
  for (std::int64_t i = 0; i < matches.count(); ++i) {
    if (matches.kept(i) != 0) {
      kept_px_.push_back(place_in(matches.template_px, i));
    } else if (rejected++ % stride == 0) {
      template_px_.push_back(place_in(matches.template_px, i));
      image_px_.push_back(place_in(matches.image_px, i));
    }
  }
}

CoherentRejects RejectedMatches::look(const Correspondences& matches) {
  const std::uint8_t* kept = matches.kept.data();
  const std::int64_t rejected = std::count(kept, kept + matches.count(), 0);
  const std::int64_t stride = rejected / kMostLookedAt + 1;
  choose(matches, stride);
  CoherentRejects found;
  if (template_px_.size() <= kNeighbours || kept_px_.empty()) return found;
  // The kept matches reach as far as a twelfth of what they cover.
  const double reach_px = diagonal_px(kept_px_) / 12.0;
  for (std::size_t i = 0; i < template_px_.size(); ++i) {
    if (!is_coherent(i)) continue;
    found.count += static_cast<int>(stride);
    double nearest_px = std::numeric_limits<double>::infinity();
    for (const Eigen::Vector2d& place : kept_px_) {
      nearest_px = std::min(nearest_px, (place - template_px_[i]).norm());
    }
    found.elsewhere += nearest_px > reach_px ? static_cast<int>(stride) : 0;
  }
  return found;
}

}  // namespace weft
