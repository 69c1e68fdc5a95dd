// SPDX-License-Identifier: Apache-2.0
#include "local_maps.hpp"

#include <cmath>
#include <cstdint>
#include <weft/core/index.hpp>
#include <weft/core/statistics.hpp>
#include <weft/core/stop_check.hpp>

namespace weft::famouri_local {

void LocalMaps::gather(std::span<const solvers::SeenPoint> points, const Camera& camera,
                       const Points3View& rest_m, int neighbours, double reach_m) {
  nearest_.build(rest_places(points, rest_m));
  etas_.clear();
  for (const solvers::SeenPoint& point : points) {
    etas_.emplace_back((point.seen_px.x() - camera.cx) / camera.fx,
                       (point.seen_px.y() - camera.cy) / camera.fy);
  }
  const std::vector<RestPlace>& places = nearest_.places();
  gathered_.resize(places.size());
  std::vector<NearPlace> near;
  for (std::size_t i = 0; i < places.size(); ++i) {
    worked(100 + 10 * neighbours);
    const auto own = static_cast<std::int32_t>(i);
    nearest_.find(own, to_index(neighbours), reach_m, near);
    const auto axes = places[i].axes();
    Gathered& gathered = gathered_[i];
    gathered.samples.clear();
    bool has_own = false;
    for (const NearPlace& each : near) {
      const std::size_t j = to_index(each.index);
      if (each.index == own) gathered.own = gathered.samples.size(), has_own = true;
      gathered.samples.push_back({places[i].laid_out(places[j].at_m, axes), etas_[j]});
    }
    if (!has_own) gathered.samples.clear();  // as many others are in the very same place
  }
}

void LocalMaps::fit(const MapExpectation& expected) {
  maps_.resize(gathered_.size());
  for (std::size_t i = 0; i < gathered_.size(); ++i) {
    const Gathered& gathered = gathered_[i];
    worked(50 * static_cast<std::int64_t>(gathered.samples.size()));
    maps_[i] = fit_.fit(gathered.samples, gathered.own, expected);
  }
}

double LocalMaps::noise() const {
  std::vector<double> noises2;
  for (const auto& map : maps_) {
    if (map) noises2.push_back(map->noise2);
  }
  return std::sqrt(median_in_place(noises2));
}

double LocalMaps::mean_count() const {
  double count = 0.0;
  for (const Gathered& gathered : gathered_) count += static_cast<double>(gathered.samples.size());
  return count / std::fmax(1.0, static_cast<double>(gathered_.size()));
}

}  // namespace weft::famouri_local
