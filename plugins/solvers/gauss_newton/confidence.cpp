// SPDX-License-Identifier: Apache-2.0
#include "confidence.hpp"

#include <cmath>

namespace weft::gauss_newton {

double confidence(const Fit& fit, const ShapeEvidence& evidence) {
  const double agreeing_share = (1.0 + evidence.agreeing) / (1.0 + evidence.kept);
  return logistic(4.0 - 0.418 * std::log(fit.residual_px + 0.1) + 0.169 * std::log(agreeing_share) +
                  2.119 * std::log(evidence.coverage + 0.05));
}

}  // namespace weft::gauss_newton
