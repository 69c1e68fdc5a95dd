// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

namespace weft::adalam {

/// Matches around a seed, relative to it and in radii of the two neighbourhoods; the most trusted
/// first.
struct Neighbourhood {
  std::vector<Eigen::Vector2d> in_template, in_image;

  std::size_t size() const { return in_template.size(); }
};

struct Settings {
  double min_confidence = 200.0;
  int most_draws = 128;
  double most_stretch = 5.0;  ///< singular values of a map are between its inverse and this
};

/// Which matches of a neighbourhood agree with one linear map, and how surely.
///
/// A mismatch is anywhere in the neighbourhood: of m, m r^2 are within r of a map by chance. The
/// confidence of k matches within r is k / (m r^2) (Cavalli et al. 2020, Section 3.3).
struct Agreement {
  std::vector<double> confidence;  ///< [m] largest confidence of a set that holds the match
  std::size_t agreeing = 0;        ///< size of the largest set whose confidence is enough
  double sureness = 0.0;           ///< the confidence of this set
};

/// Samples linear maps through the seed and two matches, the most trusted pairs first, until a
/// better one is unlikely (1 in 10,000). Fits the best map to the matches that agree with it.
Agreement agreement_of(const Neighbourhood& around, const Settings& settings);

}  // namespace weft::adalam
