// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>
#include <weft/geometry/distance_constraints.hpp>
#include <weft/sdk/call.hpp>

#include "choreography.hpp"

namespace weft::frex {

/// One moment of the surface.
struct SheetState {
  Points3 vertices_m;            ///< [V,3] m, camera frame
  double residual_strain = 0.0;  ///< [] largest of an edge against the length that it should have
  StrainStatistics true_strain;  ///< strain of the edges against the surface at rest: elasticity
                                 ///< and residue
};

/// The simulated surface, frame after frame. It simulates and keeps all frames before a requested
/// one, so that each frame is the same for any order of requests.
class SheetFilm {
 public:
  static Result<SheetFilm> create(const MotionSettings& settings, const RestSheet& sheet,
                                  double fps);

  /// Frame `index` from 0, valid until the next call. Fails when the surface cannot follow, or as
  /// soon as the call is cancelled.
  Result<const SheetState*> at(std::int64_t index, const Call& call);

 private:
  SheetFilm(Choreography choreography, scene::Cloth cloth,
            std::vector<DistanceConstraint> rest_edges, double fps);
  SheetState state_now() const;

  Choreography choreography_;
  scene::Cloth cloth_;
  std::vector<DistanceConstraint> rest_edges_;
  double fps_;
  std::vector<SheetState> states_;
};

}  // namespace weft::frex
