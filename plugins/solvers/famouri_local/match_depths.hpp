// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>
#include <weft/data/camera.hpp>
#include <weft/geometry/types.hpp>

#include "common/seen/seen_points.hpp"
#include "local_depth.hpp"
#include "local_maps.hpp"

namespace weft::famouri_local {

/// How the depths are found.
struct DepthOptions {
  int neighbours = 30;    ///< [] matches that a local map is fitted to, at most, with its own
  double reach = 0.25;    ///< [] parts of the template's diagonal, from a match to its neighbours
  double bend_rad = 2.0;  ///< [] rad along the template's diagonal, expected of its surface
};

/// The matches of a frame whose depth is known.
struct MatchDepths {
  std::vector<solvers::SeenPoint> points;  ///< [n]
  std::vector<LocalDepth> depths;          ///< [n]
  double noise_px = 0.0;                   ///< [] px, along u and v, estimated from the local maps
  double mean_count = 0.0;                 ///< [] matches that share a local map, in the mean
  int contradicting = 0;  ///< [] matches without a depth: their neighbours contradict their image
                          ///< points
  int undetermined = 0;   ///< [] too few neighbours, or on a line
  int folded = 0;         ///< [] their map folds, or is thin, or may well be so
  int odd = 0;            ///< [] unlike all others
};

/// Finds the depth of each match from the matches around it.
class DepthFinder {
 public:
  /// `rest_m` [V,3] m, the template's vertices at rest; `frontal_m`, the rough distance.
  const MatchDepths& find(const std::vector<solvers::SeenPoint>& points, const Camera& camera,
                          const Points3View& rest_m, double frontal_m, const DepthOptions& options);

 private:
  void leave_out_contradicting(const std::vector<solvers::SeenPoint>& points, double noise,
                               double focal_px);
  void read_depths();
  void leave_out_odd();

  LocalMaps maps_;
  std::vector<solvers::SeenPoint> agreeing_;  ///< those that do not contradict their neighbours
  MatchDepths found_;
};

}  // namespace weft::famouri_local
