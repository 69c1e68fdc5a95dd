// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace weft::brunet_refine {

/// How well a surface keeps its lengths and meets its matches.
struct Fit {
  double strain = 0.0;       ///< [] mean |l / l0 - 1| over the edges of the mesh
  double residual_px = 0.0;  ///< [] px, median over the matches; infinite behind the camera
  double coverage = 0.0;     ///< [] 0 to 1, as in ShapeEvidence
};

/// The probability that the mean error of the visible vertices is below 2 % of the template's
/// diagonal. It is a logistic function, fitted to shapes with ground truth, see README.md.
double confidence(const Fit& fit);

}  // namespace weft::brunet_refine
