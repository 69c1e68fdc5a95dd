// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace weft::aem {

/// The properties of a coherent set that determine its confidence.
struct Evidence {
  double log_likelihood = 0.0;
  double matches = 0.0;  ///< all
  double correct = 0.0;  ///< those of the set
  double sigmas = 1.0;   ///< standard deviation of its residuals, in multiples of the least sigma
};

/// Probability that the set is the object: that at least half of it are inliers, and that it holds
/// at least half of all inliers. A logistic function, fitted to sets with ground truth.
double confidence(const Evidence& evidence);

/// Largest harmless rival: the log-likelihood of the best other set, divided by that of the set
/// itself.
inline constexpr double kHarmlessRival = 0.8;
/// Factor on the confidence where a rival is as likely.
inline constexpr double kAmbiguous = 0.5;

/// Factor on the confidence beside a rival: 1, falling to kAmbiguous.
double trust_beside(double rival);

}  // namespace weft::aem
