// SPDX-License-Identifier: Apache-2.0
#include <weft/core/index.hpp>
#include <weft/sdk/matcher.hpp>

#include "common/distances/coarse_hamming.hpp"
#include "common/distances/coarse_l2.hpp"
#include "common/ratio_matching.hpp"
#include "nearest_search.hpp"

namespace weft::descriptor {
namespace {

/// Nearest descriptor with Lowe's ratio test, exact.
class Descriptor final : public Matcher {
 public:
  static constexpr About kAbout{
      .reference =
          "paper: Lowe, Distinctive image features from scale-invariant keypoints, IJCV 2004; "
          "Arandjelovic and Zisserman, Three things everyone should know to improve object "
          "retrieval, CVPR 2012",
      .needs = "keypoints template_keypoints"};

  explicit Descriptor(Params& p) : matching_(p) {}

  Result<Correspondences> match(const MatcherInput& in) override {
    auto sides = matching_.sides(in);
    if (!sides) return sides.error();
    const NearestSearch::Options options{.elsewhere_px = matching_.elsewhere_px(),
                                         .mutual = matching_.mutual(),
                                         .ratio = matching_.ratio(),
                                         .threads = in.call.threads()};
    if (!search_.run(load(sides->queries, sides->trains, in.call.threads()), sides->trains.xy_px,
                     options, [&] { return in.call.cancelled(); })) {
      return Error{Errc::cancelled, "cancelled"};
    }
    neighbours_.clear();
    for (int query = 0; query < static_cast<int>(search_.nearest().size()); ++query) {
      const Nearest& found = search_.nearest()[to_index(query)];
      if (found.second < 0) continue;
      neighbours_.push_back({query, found.best, found.distance, found.second_distance});
    }
    return matching_.answer(*sides, neighbours_);
  }

 private:
  matchers::CoarseDistances& load(const Keypoints& queries, const Keypoints& trains, int threads) {
    if (queries.metric == "hamming") {
      hamming_.load(queries.binary_descriptors, trains.binary_descriptors);
      return hamming_;
    }
    l2_.load(queries.descriptors, trains.descriptors, matching_.root_sift(), queries.revision,
             trains.revision, threads);
    return l2_;
  }

  matchers::RatioMatching matching_;
  matchers::CoarseL2 l2_;
  matchers::CoarseHamming hamming_;
  NearestSearch search_;
  std::vector<matchers::Neighbours> neighbours_;
};

}  // namespace
}  // namespace weft::descriptor

using weft::descriptor::Descriptor;
WEFT_PLUGIN(Descriptor, "matchers/descriptor", "1.1.1",
            "Matches keypoints to the nearest descriptor with Lowe's ratio test, exactly.")
