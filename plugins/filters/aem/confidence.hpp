// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace weft::aem {

/// What is known of a coherent set.
struct Evidence {
  double log_likelihood = 0.0;
  double matches = 0.0;  ///< all
  double correct = 0.0;  ///< those of the set
  double sigmas = 1.0;   ///< of its residuals, in parts of the least sigma
};

/// Probability that the set is the object: that at least half of it is correct and it holds at
/// least half of the correct matches. A logistic fitted to sets of which the truth is known.
double confidence(const Evidence& evidence);

/// A rival, the log-likelihood of the best other set in parts of one's own, is no matter up to
/// this.
inline constexpr double kHarmlessRival = 0.8;
/// By what the confidence is multiplied where a rival is as likely.
inline constexpr double kAmbiguous = 0.5;

/// By what the confidence is multiplied beside a rival: 1, falling to kAmbiguous.
double trust_beside(double rival);

}  // namespace weft::aem
