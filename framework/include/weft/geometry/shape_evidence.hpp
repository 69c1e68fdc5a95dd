// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <weft/data/shape.hpp>
#include <weft/geometry/evidence_count.hpp>

namespace weft {

/// The rule for the shapes of all solvers: `estimated` if it is likelier right than wrong, and if
/// the image shows it, widely and more than by chance; otherwise `weak`. Where a solver takes
/// neither matches nor sightlines, its confidence alone tells.
inline ShapeState state_of(const ShapeEvidence& evidence, double confidence) {
  constexpr double kLeastShare = 0.25, kLeastCoverage = 0.25, kLeastConfidence = 0.5;
  const bool shown = evidence.needed == 0 || (evidence.agreeing >= evidence.needed &&
                                              evidence.agreeing >= kLeastShare * evidence.kept &&
                                              evidence.coverage >= kLeastCoverage);
  return shown && confidence >= kLeastConfidence ? ShapeState::estimated : ShapeState::weak;
}

/// By the matches where they are wired, else by the sightlines.
template <class Vertices>
ShapeEvidence shape_evidence(const Template& templ, const Camera& camera,
                             const Vertices& vertices_m,
                             const std::optional<Correspondences>& matches,
                             const std::optional<Sightlines>& sightlines) {
  EvidenceCount count(templ, camera, vertices_m);
  if (matches) return count.of(*matches);
  return sightlines ? count.of(*sightlines) : ShapeEvidence{};
}

/// A filter may know of a likelier place for the object, such as a copy of it: what it said, or 1.
inline double confidence_of_filters(const std::optional<Correspondences>& matches) {
  if (!matches || !matches->confidence.present()) return 1.0;
  return std::clamp(*matches->confidence.data(), 0.0, 1.0);
}

/// 1 / (1 + exp(-logit))
inline double logistic(double logit) { return 1.0 / (1.0 + std::exp(-logit)); }

}  // namespace weft
