// SPDX-License-Identifier: Apache-2.0
#include <weft/core/index.hpp>
#include <weft/sdk/matcher.hpp>

#include "common/ratio_matching.hpp"
#include "hamming_distances.hpp"
#include "l2_distances.hpp"
#include "nearest_search.hpp"

namespace weft::descriptor {
namespace {

/// Nearest descriptor with Lowe's ratio test, exact.
class Descriptor final : public Matcher {
 public:
  static constexpr About kAbout{
      .reference =
          "Lowe, Distinctive image features from scale-invariant keypoints, IJCV 2004; "
          "Arandjelovic and Zisserman, Three things everyone should know to improve object "
          "retrieval, CVPR 2012",
      .needs = "keypoints template_keypoints"};

  explicit Descriptor(Params& p) : matching_(p) {}

  Result<Correspondences> match(const MatcherInput& in) override {
    auto sides = matching_.sides(in);
    if (!sides) return sides.error();
    const DistanceRows& distances = load(sides->queries, sides->trains);
    if (!search_.run(distances, sides->trains.xy_px, {matching_.elsewhere_px(), matching_.mutual()},
                     [&] { return in.call.cancelled(); })) {
      return Error{Errc::cancelled, "cancelled"};
    }
    neighbours_.clear();
    for (int i = 0; i < distances.queries(); ++i) {
      const auto [best, second] = search_.nearest()[to_index(i)];
      if (best < 0 || second < 0) continue;
      if (matching_.mutual() && search_.best_query(best) != i) continue;
      neighbours_.push_back({i, best, distances.distance(i, best), distances.distance(i, second)});
    }
    return matching_.answer(*sides, neighbours_);
  }

 private:
  const DistanceRows& load(const Keypoints& queries, const Keypoints& trains) {
    if (queries.metric == "hamming") {
      hamming_.load(queries.binary_descriptors, trains.binary_descriptors);
      return hamming_;
    }
    l2_.load(queries.descriptors, trains.descriptors, matching_.root_sift());
    return l2_;
  }

  matchers::RatioMatching matching_;
  L2Distances l2_;
  HammingDistances hamming_;
  NearestSearch search_;
  std::vector<matchers::Neighbours> neighbours_;
};

}  // namespace
}  // namespace weft::descriptor

using weft::descriptor::Descriptor;
WEFT_PLUGIN(Descriptor, "matchers/descriptor", "1.0.0",
            "Matches keypoints by their nearest descriptor with Lowe's ratio test, exactly.")
