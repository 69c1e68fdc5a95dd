// SPDX-License-Identifier: Apache-2.0
#include "confidence.hpp"

#include <algorithm>
#include <cmath>
#include <weft/geometry/shape_evidence.hpp>

namespace weft::brunet_mdh {
namespace {

constexpr double kFewestMatches = 4.0;  // three agree with some affine map whatever they are

}  // namespace

double confidence(double strain, int agreeing_matches) {
  const double logit =
      -17.02 - 2.711 * std::log(strain + 1e-3) + 1.524 * std::log(1.0 + agreeing_matches);
  return std::min(1.0, agreeing_matches / kFewestMatches) * logistic(logit);
}

}  // namespace weft::brunet_mdh
