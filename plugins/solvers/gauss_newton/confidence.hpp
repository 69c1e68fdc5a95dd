// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/geometry/shape_evidence.hpp>

#include "fit.hpp"

namespace weft::gauss_newton {

/// The probability that the mean error of the visible vertices is below 2 % of the template's
/// diagonal. It is a logistic function, fitted to shapes with ground truth, see README.md.
double confidence(const Fit& fit, const ShapeEvidence& evidence);

}  // namespace weft::gauss_newton
