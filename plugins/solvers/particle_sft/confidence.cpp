// SPDX-License-Identifier: Apache-2.0
#include "confidence.hpp"

#include <cmath>

namespace weft::particle_sft {

double confidence(const Fit& fit, const solvers::Agreement& agreement) {
  const double agreeing = 1.0 + agreement.agreeing;
  return solvers::logistic(-17.49 - 2.105 * std::log(fit.residual_px + 0.1) -
                           2.215 * std::log(fit.strain + 1e-3) + 0.946 * std::log(agreeing) +
                           0.299 * std::log(agreeing / (1.0 + agreement.kept)));
}

}  // namespace weft::particle_sft
