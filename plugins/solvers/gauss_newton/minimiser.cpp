// SPDX-License-Identifier: Apache-2.0
#include "minimiser.hpp"

namespace weft::gauss_newton {

Result<void> Minimiser::prepare(const MeshModel& mesh) {
  energy_.prepare(mesh);
  return newton_.prepare(mesh.rest_m, mesh.couplings);
}

MinimiserResult Minimiser::run(const FrameData& frame, const Expectation& expected,
                               const Scales& scales, const MinimiserOptions& options,
                               Points3& vertices_m) {
  constexpr double kFollowed = 0.5;
  const auto linearise = [&](int iteration, const Points3& shape_m, Points3& gradient,
                             BlockMatrix& matrix) {
    // Full correction of the chords for a ripple would produce the opposite ripple.
    energy_.follow(shape_m, iteration == 0 ? 1.0 : kFollowed);
    energy_.meet_outline(frame, scales, shape_m);
    return energy_.linearise(frame, expected, scales, shape_m, gradient, matrix);
  };
  const auto value = [&](const Points3& shape_m) {
    return energy_.value(frame, expected, scales, shape_m);
  };
  return newton_.run(options, linearise, value, vertices_m);
}

}  // namespace weft::gauss_newton
