// SPDX-License-Identifier: Apache-2.0
#include "confidence.hpp"

#include <cmath>

namespace weft::particle_sft {

double confidence(const Fit& fit, const ShapeEvidence& evidence) {
  const double agreeing_share = (1.0 + evidence.agreeing) / (1.0 + evidence.kept);
  return logistic(-11.98 - 0.418 * std::log(fit.residual_px + 0.1) -
                  2.627 * std::log(fit.strain + 1e-3) + 0.169 * std::log(agreeing_share) +
                  2.119 * std::log(evidence.coverage + 0.05));
}

}  // namespace weft::particle_sft
