// SPDX-License-Identifier: Apache-2.0
#include "confidence.hpp"

#include <algorithm>
#include <cmath>

namespace weft::aem {

double confidence(const Evidence& evidence) {
  if (!(evidence.correct > 0.0) || !(evidence.log_likelihood > 0.0)) return 0.0;
  const double logit = 0.116 + 0.0616 * std::min(evidence.log_likelihood, 150.0) +
                       3.105 * std::log(evidence.correct) - 2.223 * std::log(evidence.matches) -
                       3.601 * std::log(std::max(evidence.sigmas, 1.0));
  return 1.0 / (1.0 + std::exp(-logit));
}

double trust_beside(double rival) {
  const double harm = (rival - kHarmlessRival) / (1.0 - kHarmlessRival);
  return 1.0 - (1.0 - kAmbiguous) * std::clamp(harm, 0.0, 1.0);
}

}  // namespace weft::aem
