// SPDX-License-Identifier: Apache-2.0
#include "confidence.hpp"

#include <algorithm>
#include <cmath>

namespace weft::aem {

namespace {

constexpr double kFewMatches = 50.0;

}  // namespace

double confidence(const Evidence& evidence) {
  if (!(evidence.correct > 0.0) || !(evidence.log_likelihood > 0.0)) return 0.0;
  // Among many matches, some mismatches agree within a broad sigma: clusters of them do.
  const double broad = std::log(std::max(evidence.sigmas, 1.0)) *
                       std::log(std::max(evidence.matches / kFewMatches, 1.0));
  const double logit = -0.670 + 0.0892 * std::min(evidence.log_likelihood, 150.0) +
                       2.299 * std::log(evidence.correct) - 1.995 * std::log(evidence.matches) -
                       1.771 * broad;
  return 1.0 / (1.0 + std::exp(-logit));
}

double trust_beside(double rival) {
  const double harm = (rival - kHarmlessRival) / (1.0 - kHarmlessRival);
  return 1.0 - (1.0 - kAmbiguous) * std::clamp(harm, 0.0, 1.0);
}

}  // namespace weft::aem
