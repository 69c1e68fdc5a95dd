// SPDX-License-Identifier: Apache-2.0
#include <string>
#include <utility>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/sdk/matcher.hpp>

#include "circle_search.hpp"
#include "common/distances/coarse_hamming.hpp"
#include "common/distances/coarse_l2.hpp"
#include "common/ratio_matching.hpp"
#include "guidance.hpp"

namespace weft::guided {
namespace {

std::vector<Eigen::Vector2d> places_of(const Keypoints& keypoints) {
  std::vector<Eigen::Vector2d> places;
  places.reserve(to_index(keypoints.count()));
  for (std::int64_t i = 0; i < keypoints.count(); ++i) {
    places.emplace_back(keypoints.xy_px(i, 0), keypoints.xy_px(i, 1));
  }
  return places;
}

/// Nearest descriptor near where the previous shape has it.
class Guided final : public Matcher {
 public:
  static constexpr About kAbout{
      .reference = "own: a search in circles around the previous shape, with the whole as a net",
      .needs = "keypoints template_keypoints",
      .reads = "template camera previous.shape previous.correspondences"};

  explicit Guided(Params& p) : matching_(p) {
    p.read("radius_px", radius_px_, "px", {1, 1000},
           "search radius around the keypoint position that the previous shape predicts");
    p.read("least_rivals", least_rivals_, "", {0, 1000},
           "minimum number of keypoints that a match is compared with, from the whole image if "
           "necessary");
    p.read("least_confidence", least_confidence_, "", {0, 1},
           "minimum confidence of a previous shape that is used");
    p.read("least_matches", least_matches_, "", {3, 100'000},
           "number of agreeing matches below which the whole image is searched");
    p.read("least_share", least_share_, "", {0, 1},
           "share of the matches kept in the previous frame that must agree; below it the whole "
           "image is searched");
    p.formerly("whole").component("matcher", whole_, "matcher that searches the whole image");
  }

  Result<Correspondences> match(const MatcherInput& in) override {
    auto sides = matching_.sides(in);
    if (!sides) return sides.error();
    Diagnostics evidence;
    Fallback fallback = fallback_before(in, least_confidence_);
    if (fallback == Fallback::none) {
      auto found = match_nearby(in, *sides, evidence);
      if (found) return found;
      if (found.error().code != Errc::no_result) return found;
      fallback = Fallback::few_agree;
    }
    auto whole = whole_.match(in.call, *in.keypoints, *in.template_keypoints);
    if (whole) set_evidence(0.0, fallback, evidence, whole->diag);
    return whole;
  }

 private:
  /// no_result where too few matches agree.
  Result<Correspondences> match_nearby(const MatcherInput& in, const matchers::Sides& sides,
                                       Diagnostics& evidence) {
    const std::vector<Eigen::Vector2d> predicted_px =
        predicted_places(*in.template_keypoints, *in.templ, *in.camera, *in.previous_shape);
    const std::vector<Eigen::Vector2d> image_px = places_of(*in.keypoints);
    const SidePlaces templ{predicted_px, places_of(*in.template_keypoints)};
    const SidePlaces image{image_px, image_px};
    const bool forward = matching_.forward();
    const CircleSearch::Options options{.radius_px = radius_px_,
                                        .elsewhere_px = matching_.elsewhere_px(),
                                        .least_rivals = static_cast<int>(least_rivals_),
                                        .ratio = matching_.ratio(),
                                        .mutual = matching_.mutual(),
                                        .threads = in.call.threads()};
    const auto& nearest = search_.run(load(sides.queries, sides.trains, in.call.threads()),
                                      forward ? templ : image, forward ? image : templ, options);
    neighbours_.clear();
    for (int query = 0; query < static_cast<int>(nearest.size()); ++query) {
      const matchers::Nearest& found = nearest[to_index(query)];
      if (found.second < 0) continue;
      neighbours_.push_back({query, found.best, found.distance, found.second_distance});
    }
    auto matches = matching_.answer(sides, neighbours_);
    const int agreeing = matches ? agreeing_matches(*matches, predicted_px, radius_px_) : 0;
    const int kept_before = kept_matches(*in.previous_correspondences);
    evidence.set("agreeing", agreeing);
    evidence.set("kept_before", kept_before);
    if (!matches) return matches;
    if (agreeing < least_matches_ || agreeing < least_share_ * kept_before) {
      return no_result("few matches agree");
    }
    set_evidence(static_cast<double>(matches->count()), Fallback::none, evidence, matches->diag);
    return matches;
  }

  static void set_evidence(double guided, Fallback fallback, const Diagnostics& evidence,
                           Diagnostics& diag) {
    diag.set("guided", guided);
    diag.set("fallback", static_cast<double>(fallback));
    for (const NamedArray& entry : evidence.entries()) diag.entries().push_back(entry);
  }

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
  double radius_px_ = 30.0;
  std::int64_t least_rivals_ = 16;
  double least_confidence_ = 0.5;
  std::int64_t least_matches_ = 20;
  double least_share_ = 0.5;
  MatcherComponent whole_{"matchers/descriptor"};
  matchers::CoarseL2 l2_;
  matchers::CoarseHamming hamming_;
  CircleSearch search_;
  std::vector<matchers::Neighbours> neighbours_;
};

}  // namespace
}  // namespace weft::guided

WEFT_PLUGIN(weft::guided::Guided, "matchers/guided", "1.0.2",
            "Matches keypoints near the previous shape, or in the whole image if that fails.")
