// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>
#include <weft/geometry/distance_constraints.hpp>
#include <weft/geometry/types.hpp>

#include "common/cholesky/damped_newton.hpp"
#include "energy.hpp"
#include "solid_model.hpp"

namespace weft::volume {

/// Position-based dynamics of a body (Muller, Heidelberger, Hennix and Ratcliff 2007; Ozgur and
/// Bartoli 2017). Nodes are particles. Each sweep moves observed points towards their sightlines,
/// then corrects the lengths of the edges and the volumes of the tetrahedra,
///     dx_a = -C w / (w sum_b |grad_b C|^2) grad_a C,   C = det(x1-x0, x2-x0, x3-x0) / 6 - V0.
/// Cheaper than the minimisation of an energy, and less exact.
class PositionBased {
 public:
  void prepare(const SolidModel& body);

  /// Moves nodes [K,3] m until the rms step of a sweep falls below the tolerance.
  solvers::MinimiserResult run(const FrameData& frame, const Scales& scales,
                               const solvers::MinimiserOptions& options, Points3& nodes_m);

 private:
  void pull(const FrameData& frame, const Scales& scales, Points3& nodes_m) const;
  void keep_lengths(Points3& nodes_m) const;
  void keep_volumes(Points3& nodes_m) const;

  const SolidModel* body_ = nullptr;
  std::vector<DistanceConstraint> edges_;
  std::vector<double> volumes_m3_;  ///< [E] at rest
};

}  // namespace weft::volume
