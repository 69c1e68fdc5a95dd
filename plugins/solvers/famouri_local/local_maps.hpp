// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>
#include <weft/data/camera.hpp>
#include <weft/geometry/types.hpp>

#include "common/seen/seen_points.hpp"
#include "local_map.hpp"
#include "nearest_places.hpp"

namespace weft::famouri_local {

/// The local maps of a set of matches, each from the nearest ones on the template.
class LocalMaps {
 public:
  /// `neighbours` at most for each map, with the match itself, within `reach_m` on the template
  /// whose vertices at rest are [V,3] m.
  void gather(std::span<const solvers::SeenPoint> points, const Camera& camera,
              const Points3View& rest_m, int neighbours, double reach_m);

  /// Fits one for each match; nothing where its neighbours do not determine it.
  void fit(const MapExpectation& expected);

  const std::vector<std::optional<LocalMap>>& maps() const { return maps_; }

  /// Noise of a normalised image coordinate: the median over the maps; not a number where there are
  /// none.
  double noise() const;

  /// Matches that share a map, in the mean.
  double mean_count() const;

 private:
  struct Gathered {
    std::vector<MapSample> samples;
    std::size_t own = 0;  ///< sample of the match itself
  };

  NearestPlaces nearest_;
  LocalMapFit fit_;
  std::vector<Eigen::Vector2d> etas_;          ///< [n] normalised image points
  std::vector<Gathered> gathered_;             ///< [n]
  std::vector<std::optional<LocalMap>> maps_;  ///< [n]
};

}  // namespace weft::famouri_local
