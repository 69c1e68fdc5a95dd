// SPDX-License-Identifier: Apache-2.0
#include "confidence.hpp"

#include <cmath>

#include "common/agreement.hpp"

namespace weft::brunet_mdh {

double confidence(double strain, int agreeing_matches) {
  return solvers::logistic(-17.02 - 2.711 * std::log(strain + 1e-3) +
                           1.524 * std::log(1.0 + agreeing_matches));
}

}  // namespace weft::brunet_mdh
