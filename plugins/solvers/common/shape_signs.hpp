// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <weft/data/record.hpp>
#include <weft/geometry/distance_constraints.hpp>
#include <weft/geometry/shape_evidence.hpp>
#include <weft/geometry/types.hpp>
#include <weft/sdk/nested.hpp>

namespace weft::solvers {

/// Indicators of a shape's quality without the ground truth: errors of lengths and matches, and
/// bending.
struct ShapeSigns {
  double strain = 0.0;         ///< [] mean |l / l0 - 1| over the edges
  double strain_p95 = 0.0;     ///< [] 95th percentile of it
  double residual_px = 0.0;    ///< [] px, median of the kept matches; infinite without any
  double roughness_rad = 0.0;  ///< [] rad, see shape_signs()
  double size_px = 0.0;        ///< [] px, diagonal of the box around the shape in the image
  ShapeEvidence evidence;

  /// As scalars strain, strain_p95, kept_residual_px, roughness_rad and size_px; the base class of
  /// solvers reports the evidence.
  void tell(Diagnostics& diag) const;
};

/// For vertices [V,3] m, camera frame, all in front of the camera, and the `edges` of the template.
/// Roughness compares the angle between a face and the mean of the faces at one of its corners with
/// that at rest. It is the mean over all corners. Noise of matches increases it, and so do bends.
ShapeSigns shape_signs(const SolverInput& in, std::span<const DistanceConstraint> edges,
                       const Points3View& vertices_m);

/// Weights of the logistic of confidence(), of the logarithm of each sign. Each solver has its own,
/// fitted to shapes with known truth: docs/evidence/0023-confidence-of-solvers.md.
struct ConfidenceWeights {
  double bias = 0.0;
  double strain = 0.0;      ///< weight of ln(strain + 0.001)
  double strain_p95 = 0.0;  ///< weight of ln(strain_p95 + 0.001)
  double residual = 0.0;    ///< weight of ln(residual_px + 0.1)
  double roughness = 0.0;   ///< weight of ln(roughness_rad + 0.01)
  double size = 0.0;        ///< weight of ln(size_px + 1)
  double agreeing = 0.0;    ///< weight of ln(agreeing + 1)
  double share = 0.0;       ///< weight of ln((agreeing + 1) / (kept + 1))
  double coverage = 0.0;    ///< weight of ln(coverage + 0.05)
};

/// The probability that the mean error of the visible vertices is below 2 % of the template's
/// diagonal, 1 / (1 + exp(-w . signs)), times the confidence that filters gave to the matches. It
/// is 0 for signs that are not finite, as where no match is kept.
double confidence(const ShapeSigns& signs, const ConfidenceWeights& weights,
                  const std::optional<Correspondences>& matches);

}  // namespace weft::solvers
