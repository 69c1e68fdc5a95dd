// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/geometry/shape_evidence.hpp>

#include "fit.hpp"

namespace weft::gauss_newton {

/// The probability that the mean error of what the camera sees is below 2 % of the template's
/// diagonal: a logistic fitted to shapes of which the truth is known, see README.md.
double confidence(const Fit& fit, const ShapeEvidence& evidence);

}  // namespace weft::gauss_newton
