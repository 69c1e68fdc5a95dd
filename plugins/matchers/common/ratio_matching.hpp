// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>
#include <weft/sdk/matcher.hpp>

#include "common/pruning.hpp"

namespace weft::matchers {

/// Which keypoints look for their nearest among the others.
enum class Direction { template_to_image, image_to_template };

/// The queries and the trains of a search; the keypoints borrow from the call's input.
struct Sides {
  Keypoints templ, image;
  Keypoints queries, trains;
};

/// The result of a search for a query: its nearest train, and the distances of that and of the
/// nearest one elsewhere.
struct Neighbours {
  int query, train;
  double distance, second_distance;
};

/// Matching by Lowe's ratio test around a search for nearest descriptors: its parameters, what must
/// hold before the search, and what is done with its findings. How the search is made is up to the
/// plugin; all that is on these pages is the same for every one.
class RatioMatching {
 public:
  explicit RatioMatching(Params& p);

  /// The two sides of a search; no_result or an Error where there is nothing to search.
  Result<Sides> sides(const MatcherInput& in);

  /// True if the template's keypoints are the queries.
  bool forward() const { return direction_ == Direction::template_to_image; }
  double ratio() const { return ratio_; }
  bool mutual() const { return mutual_; }
  bool root_sift() const { return root_sift_; }
  /// The second nearest train is farther than this from the nearest; 0: any other.
  double elsewhere_px() const { return second_best_radius_px_; }

  /// The matches among findings, which have passed the mutual test if it is enabled.
  Result<Correspondences> answer(const Sides& sides, const std::vector<Neighbours>& found);

 private:
  void collect(const Sides& sides, const std::vector<Neighbours>& found);

  Direction direction_ = Direction::template_to_image;
  double ratio_ = 0.8;
  bool mutual_ = false;
  bool one_to_one_ = true;
  bool root_sift_ = true;
  double duplicate_radius_px_ = 0.5;
  double second_best_radius_px_ = 3.0;
  double max_distance_ = 0.0;
  std::vector<Match> matches_;
  std::uint64_t passed_ = 0;  ///< revision of the template that was checked last
};

}  // namespace weft::matchers
