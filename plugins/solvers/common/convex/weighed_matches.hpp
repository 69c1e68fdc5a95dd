// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>
#include <weft/core/result.hpp>
#include <weft/data/camera.hpp>
#include <weft/data/correspondences.hpp>
#include <weft/data/template.hpp>
#include <weft/geometry/types.hpp>

#include "common/seen/seen_points.hpp"

namespace weft::solvers {

/// The matches of a frame that count, and how much each does: all alike at first.
class WeighedMatches {
 public:
  static constexpr std::size_t kFewest = 10;

  /// Fails as seen_points() does, with fewer than kFewest too.
  Result<void> read(const Correspondences& matches, const Template& templ);

  /// Excludes matches with errors above a radius and weighs the others by exp(-r / median r).
  /// Returns false, and changes nothing, where no error is that large or too few matches remain.
  bool weigh_again(const Points3View& vertices_m, const Camera& camera, double radius_px);

  const std::vector<SeenPoint>& points() const { return points_; }
  const std::vector<double>& weights() const { return weights_; }  ///< [n] above 0

 private:
  std::vector<SeenPoint> points_;
  std::vector<double> weights_;
};

}  // namespace weft::solvers
