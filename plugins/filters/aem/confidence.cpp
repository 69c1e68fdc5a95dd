// SPDX-License-Identifier: Apache-2.0
#include "confidence.hpp"

#include <algorithm>
#include <cmath>

namespace weft::aem {

double confidence(const Evidence& evidence) {
  if (!(evidence.correct > 0.0) || !(evidence.log_likelihood > 0.0)) return 0.0;
  const double logit = -3.3 + 0.052 * std::min(evidence.log_likelihood, 150.0) +
                       1.87 * std::log(evidence.correct) - 2.12 * std::log(evidence.matches) +
                       0.84 * evidence.log_likelihood / evidence.correct;
  return 1.0 / (1.0 + std::exp(-logit));
}

double trust_beside(double rival) {
  const double harm = (rival - kHarmlessRival) / (1.0 - kHarmlessRival);
  return 1.0 - (1.0 - kAmbiguous) * std::clamp(harm, 0.0, 1.0);
}

}  // namespace weft::aem
