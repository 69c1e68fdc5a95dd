// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <weft/sdk/matcher.hpp>

#include "checks.hpp"
#include "hamming_distances.hpp"
#include "l2_distances.hpp"
#include "nearest_search.hpp"
#include "pruning.hpp"

namespace weft::descriptor {
namespace {

/// a - b in (-pi, pi].
double angle_between(double a, double b) {
  const double difference = std::remainder(a - b, 2.0 * std::numbers::pi);
  return difference <= -std::numbers::pi ? std::numbers::pi : difference;
}

/// Which keypoints look for their nearest among the others.
enum class Direction { template_to_image, image_to_template };

/// Nearest descriptor with Lowe's ratio test, exact.
class Descriptor final : public Matcher {
 public:
  static constexpr About kAbout{
      .reference =
          "Lowe, Distinctive image features from scale-invariant keypoints, IJCV 2004; "
          "Arandjelovic and Zisserman, Three things everyone should know to improve object "
          "retrieval, CVPR 2012",
      .needs = "keypoints template_keypoints"};

  explicit Descriptor(Params& p) {
    p.choice("direction", direction_,
             {{"template_to_image", Direction::template_to_image},
              {"image_to_template", Direction::image_to_template}},
             "whose keypoints look for the nearest of the others; to image_to_template copies of "
             "the object in the image do not compete");
    p.read("ratio", ratio_, "", {0.01, 1},
           "a match is kept if its distance is below this times the second nearest distance");
    p.read("mutual", mutual_,
           "keep a match only if each of its keypoints is the nearest one of the other");
    p.read("one_to_one", one_to_one_,
           "keep only the match of smallest distance of each image point");
    p.read("root_sift", root_sift_,
           "compare sqrt(d / |d|_1) in place of d; for descriptors without negative numbers");
    p.read("duplicate_radius_px", duplicate_radius_px_, "px", {0, 100},
           "merge matches that agree within this in the template and in the image; 0 merges none");
    p.read("second_best_radius_px", second_best_radius_px_, "px", {0, 1000},
           "the second nearest is taken farther than this from the nearest; 0 takes any other");
    p.read("max_distance", max_distance_, "", {0, 1000000},
           "largest distance of a match (RootSIFT: up to 1.42, hamming: bits); 0 is no limit");
  }

  Result<Correspondences> match(const MatcherInput& in) override {
    if (!in.keypoints || !in.template_keypoints) {
      return Error{Errc::invalid_data,
                   "matching needs keypoints of the image and of the template; "
                   "put a detector before this stage",
                   {}};
    }
    const Keypoints &image = *in.keypoints, &templ = *in.template_keypoints;
    const Keypoints &queries = forward() ? templ : image, &trains = forward() ? image : templ;
    if (queries.count() == 0) return no_result("no keypoints " + place_of(forward()));
    if (trains.count() < 2) {
      return no_result(std::to_string(trains.count()) + " keypoints " + place_of(!forward()) +
                       ": the ratio test needs at least 2");
    }
    if (auto usable = check(templ, image, root_sift_); !usable) return usable.error();

    const DistanceRows& distances = load(queries, trains);
    if (!search_.run(distances, trains.xy_px, {second_best_radius_px_, mutual_},
                     [&] { return in.call.cancelled(); })) {
      return Error{Errc::cancelled, "cancelled", {}};
    }
    collect(distances, templ, image);
    if (one_to_one_) keep_one_per_image_point(matches_);
    merge_duplicates(duplicate_radius_px_, matches_);
    if (matches_.empty()) {
      return no_result("0 matches: none of " + std::to_string(templ.count()) +
                       " template keypoints passed the tests against " +
                       std::to_string(image.count()) + " image keypoints");
    }
    return answer(templ, image);
  }

 private:
  bool forward() const { return direction_ == Direction::template_to_image; }

  static std::string place_of(bool on_template) {
    return on_template ? "on the template" : "in the image";
  }

  const DistanceRows& load(const Keypoints& queries, const Keypoints& trains) {
    if (queries.metric == "hamming") {
      hamming_.load(queries.binary_descriptors, trains.binary_descriptors);
      return hamming_;
    }
    l2_.load(queries.descriptors, trains.descriptors, root_sift_);
    return l2_;
  }

  /// The matches that pass the tests on distances, by template keypoint, then by image keypoint.
  void collect(const DistanceRows& distances, const Keypoints& templ, const Keypoints& image) {
    matches_.clear();
    for (int i = 0; i < distances.queries(); ++i) {
      const auto [best, second] = search_.nearest()[static_cast<std::size_t>(i)];
      if (best < 0 || second < 0) continue;
      if (mutual_ && search_.best_query(best) != i) continue;
      const double distance = distances.distance(i, best);
      const double second_distance = distances.distance(i, second);
      if (!(distance < ratio_ * second_distance)) continue;
      if (max_distance_ > 0.0 && distance > max_distance_) continue;
      const int t = forward() ? i : best, m = forward() ? best : i;
      matches_.push_back({t,
                          m,
                          {templ.xy_px(t, 0), templ.xy_px(t, 1)},
                          {image.xy_px(m, 0), image.xy_px(m, 1)},
                          distance,
                          distance / second_distance});
    }
    if (forward()) return;
    std::sort(matches_.begin(), matches_.end(), [](const Match& a, const Match& b) {
      return std::pair(a.template_keypoint, a.image_keypoint) <
             std::pair(b.template_keypoint, b.image_keypoint);
    });
  }

  Correspondences answer(const Keypoints& templ, const Keypoints& image) const {
    const auto count = static_cast<std::int64_t>(matches_.size());
    Correspondences out;
    out.template_px = Array<double>({count, 2});
    out.image_px = Array<double>({count, 2});
    out.template_keypoint = Array<std::int32_t>({count});
    out.image_keypoint = Array<std::int32_t>({count});
    out.face = Array<std::int32_t>({count});
    out.barycentrics = Array<double>({count, 3});
    out.distance = Array<double>({count});
    out.ratio = Array<double>({count});
    out.scale_ratio = Array<double>({count});
    out.angle_difference_rad = Array<double>({count});
    out.kept = Array<std::uint8_t>({count});
    out.score = Array<double>({count});
    for (std::int64_t n = 0; n < count; ++n) {
      const Match& match = matches_[static_cast<std::size_t>(n)];
      const int i = match.template_keypoint, j = match.image_keypoint;
      out.template_px.matrix<2>().row(n) = match.template_px.transpose();
      out.image_px.matrix<2>().row(n) = match.image_px.transpose();
      out.template_keypoint(n) = i;
      out.image_keypoint(n) = j;
      out.face(n) = templ.face.present() ? templ.face(i) : -1;
      if (templ.barycentrics.present()) {
        out.barycentrics.matrix<3>().row(n) = templ.barycentrics.matrix<3>().row(i);
      }
      out.distance(n) = match.distance;
      out.ratio(n) = match.ratio;
      out.scale_ratio(n) = image.scale_px(j) / templ.scale_px(i);
      out.angle_difference_rad(n) = angle_between(image.angle_rad(j), templ.angle_rad(i));
      out.kept(n) = 1;
      out.score(n) = 1.0;
    }
    return out;
  }

  Direction direction_ = Direction::template_to_image;
  double ratio_ = 0.8;
  bool mutual_ = false;
  bool one_to_one_ = true;
  bool root_sift_ = true;
  double duplicate_radius_px_ = 0.5;
  double second_best_radius_px_ = 3.0;
  double max_distance_ = 0.0;
  L2Distances l2_;
  HammingDistances hamming_;
  NearestSearch search_;
  std::vector<Match> matches_;
};

}  // namespace
}  // namespace weft::descriptor

WEFT_PLUGIN(weft::descriptor::Descriptor, "matchers/descriptor", "1.0.0",
            "Matches keypoints by their nearest descriptor with Lowe's ratio test, exactly.")
