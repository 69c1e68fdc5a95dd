// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <weft/data/shape.hpp>
#include <weft/geometry/evidence_count.hpp>

namespace weft {

/// The common rule for the state of a shape. It is `estimated` if its confidence is at least 1/2
/// and the image confirms it, widely and more than by chance. Otherwise it is `weak`. Without
/// matches and sightlines, the confidence alone decides.
inline ShapeState state_of(const ShapeEvidence& evidence, double confidence) {
  constexpr double kLeastShare = 0.25, kLeastCoverage = 0.25, kLeastConfidence = 0.5;
  const bool shown = evidence.needed == 0 || (evidence.agreeing >= evidence.needed &&
                                              evidence.agreeing >= kLeastShare * evidence.kept &&
                                              evidence.coverage >= kLeastCoverage);
  return shown && confidence >= kLeastConfidence ? ShapeState::estimated : ShapeState::weak;
}

/// Uses the matches if they are connected, else the sightlines.
template <class Vertices>
ShapeEvidence shape_evidence(const Template& templ, const Camera& camera,
                             const Vertices& vertices_m,
                             const std::optional<Correspondences>& matches,
                             const std::optional<Sightlines>& sightlines) {
  EvidenceCount count(templ, camera, vertices_m);
  if (matches) return count.of(*matches);
  return sightlines ? count.of(*sightlines) : ShapeEvidence{};
}

/// The filters' confidence, or 1. A filter may detect a more likely place of the object, such as a
/// copy.
inline double confidence_of_filters(const std::optional<Correspondences>& matches) {
  if (!matches || !matches->confidence.present()) return 1.0;
  return std::clamp(*matches->confidence.data(), 0.0, 1.0);
}

/// 1 / (1 + exp(-logit))
inline double logistic(double logit) { return 1.0 / (1.0 + std::exp(-logit)); }

}  // namespace weft
