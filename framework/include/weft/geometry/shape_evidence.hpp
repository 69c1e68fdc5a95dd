// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <weft/data/shape.hpp>
#include <weft/geometry/evidence_count.hpp>

namespace weft {

/// Minimum values of a shape that is `estimated`.
struct ShapeRule {
  static constexpr double kLeastShare = 0.25;      ///< [] share of the kept measurements
  static constexpr double kLeastCoverage = 0.25;   ///< [] share of the visible surface
  static constexpr double kLeastConfidence = 0.5;  ///< [] confidence of the shape
};

/// The common rule for the state of a shape. It is `estimated` if its confidence is at least 1/2
/// and the image confirms it, widely and more than by chance. Otherwise it is `weak`. Without
/// matches and sightlines, the confidence alone decides.
inline ShapeState state_of(const ShapeEvidence& evidence, double confidence) {
  const bool shown =
      evidence.needed == 0 || (evidence.agreeing >= evidence.needed &&
                               evidence.agreeing >= ShapeRule::kLeastShare * evidence.kept &&
                               evidence.coverage >= ShapeRule::kLeastCoverage);
  return shown && confidence >= ShapeRule::kLeastConfidence ? ShapeState::estimated
                                                            : ShapeState::weak;
}

/// The first criterion of state_of() that a shape fails, as a sentence; empty for an estimated one.
inline std::string why_weak(const ShapeEvidence& evidence, double confidence) {
  if (state_of(evidence, confidence) == ShapeState::estimated) return {};
  const auto percent = [](double share) {
    return std::to_string(static_cast<int>(std::floor(100.0 * share))) + " %";
  };
  const std::string kind = evidence.needed == kNeededSightlines ? "sightlines" : "matches";
  const int least = std::max(evidence.needed,
                             static_cast<int>(std::ceil(ShapeRule::kLeastShare * evidence.kept)));
  if (evidence.needed > 0 && evidence.agreeing < least) {
    return "weak: only " + std::to_string(evidence.agreeing) + " of " +
           std::to_string(evidence.kept) + " " + kind + " agree with the shape, " +
           std::to_string(least) + " are needed";
  }
  if (evidence.needed > 0 && !(evidence.coverage >= ShapeRule::kLeastCoverage)) {
    return "weak: the agreeing " + kind + " cover " + percent(evidence.coverage) +
           " of the visible surface, " + percent(ShapeRule::kLeastCoverage) + " are needed";
  }
  const double positive = confidence > 0.0 ? confidence : 0.0;  // also for NaN
  const std::string hundredths =
      std::to_string(100 + static_cast<int>(std::floor(100.0 * positive)));
  return "weak: confidence 0." + hundredths.substr(1) + " is below 0.5";
}

/// Uses the matches if they are connected, else the sightlines. `memory` is used again, if given.
template <class Vertices>
ShapeEvidence shape_evidence(const Template& templ, const Camera& camera,
                             const Vertices& vertices_m,
                             const std::optional<Correspondences>& matches,
                             const std::optional<Sightlines>& sightlines,
                             EvidenceMemory* memory = nullptr) {
  EvidenceCount count(templ, camera, vertices_m,
                      memory != nullptr ? std::move(*memory) : EvidenceMemory{});
  ShapeEvidence evidence;
  if (matches) {
    evidence = count.of(*matches);
  } else if (sightlines) {
    evidence = count.of(*sightlines);
  }
  if (memory != nullptr) *memory = count.take_memory();
  return evidence;
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
