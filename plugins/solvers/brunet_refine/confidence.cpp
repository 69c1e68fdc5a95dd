// SPDX-License-Identifier: Apache-2.0
#include "confidence.hpp"

#include <cmath>
#include <weft/geometry/shape_evidence.hpp>

namespace weft::brunet_refine {

double confidence(const Fit& fit) {
  return logistic(-9.507 - 2.317 * std::log(fit.strain + 1e-3) -
                  2.102 * std::log(fit.residual_px + 0.1) + 1.781 * std::log(fit.coverage + 0.05));
}

}  // namespace weft::brunet_refine
