// SPDX-License-Identifier: Apache-2.0
#include "common/ratio_matching.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <weft/core/index.hpp>
#include <weft/data/matrix.hpp>

#include "common/checks.hpp"

namespace weft::matchers {
namespace {

/// a - b in (-pi, pi].
double angle_between(double a, double b) {
  const double difference = std::remainder(a - b, 2.0 * std::numbers::pi);
  return difference <= -std::numbers::pi ? std::numbers::pi : difference;
}

std::string place_of(bool on_template) { return on_template ? "on the template" : "in the image"; }

Correspondences correspondences(const std::vector<Match>& matches, const Keypoints& templ,
                                const Keypoints& image) {
  const auto count = static_cast<std::int64_t>(matches.size());
  Correspondences out;
  out.template_px = Array<double>({count, 2});
  out.image_px = Array<double>({count, 2});
  out.template_keypoint = Array<std::int32_t>({count});
  out.image_keypoint = Array<std::int32_t>({count});
  out.face = Array<std::int32_t>({count});
  out.barycentrics = Array<double>({count, 3}, 0.0);
  out.distance = Array<double>({count});
  out.ratio = Array<double>({count});
  out.scale_ratio = Array<double>({count});
  out.angle_difference_rad = Array<double>({count});
  out.kept = Array<std::uint8_t>({count});
  out.score = Array<double>({count});
  for (std::int64_t n = 0; n < count; ++n) {
    const Match& match = matches[to_index(n)];
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

}  // namespace

RatioMatching::RatioMatching(Params& p) {
  p.choice("direction", direction_,
           {{"template_to_image", Direction::template_to_image},
            {"image_to_template", Direction::image_to_template}},
           "direction of the nearest-neighbour search; with image_to_template, copies of the "
           "object in the image do not compete");
  p.read(
      "ratio", ratio_, "", {0.01, 1},
      "ratio of the nearest to the second nearest descriptor distance below which a match is kept");
  p.read("mutual", mutual_, "restriction to matches whose keypoints are nearest to each other");
  p.read("one_to_one", one_to_one_,
         "restriction to the match of smallest distance of each image point");
  p.read("root_sift", root_sift_,
         "comparison of sqrt(d / |d|_1) instead of d; for descriptors without negative numbers");
  p.read(
      "duplicate_radius_px", duplicate_radius_px_, "px", {0, 100},
      "distance in the template and in the image within which matches are merged; 0: no merging");
  p.read("second_best_radius_px", second_best_radius_px_, "px", {0, 1000},
         "minimum distance of the second nearest keypoint from the nearest; 0: none");
  p.read(
      "max_distance", max_distance_, "", {0, 1000000},
      "maximum descriptor distance of a match (RootSIFT: up to 1.42, hamming: bits); 0: no limit");
}

Result<Sides> RatioMatching::sides(const MatcherInput& in) {
  if (!in.keypoints || !in.template_keypoints) {
    return Error{Errc::invalid_data,
                 "matching needs keypoints of the image and of the template; "
                 "put a detector before this stage"};
  }
  const Keypoints &image = *in.keypoints, &templ = *in.template_keypoints;
  const Sides sides{templ, image, forward() ? templ : image, forward() ? image : templ};
  if (sides.queries.count() == 0) return no_result("no keypoints " + place_of(forward()));
  if (sides.trains.count() < 2) {
    return no_result(std::to_string(sides.trains.count()) + " keypoints " + place_of(!forward()) +
                     ": the ratio test needs at least 2");
  }
  const bool template_passed = templ.revision != 0 && templ.revision == passed_;
  if (auto usable = check(templ, image, root_sift_, template_passed); !usable) {
    return usable.error();
  }
  passed_ = templ.revision;
  return sides;
}

/// The matches that pass the tests on distances, by template keypoint, then by image keypoint.
void RatioMatching::collect(const Sides& sides, const std::vector<Neighbours>& found) {
  matches_.clear();
  for (const Neighbours& one : found) {
    if (!(one.distance < ratio_ * one.second_distance)) continue;
    if (max_distance_ > 0.0 && one.distance > max_distance_) continue;
    const int t = forward() ? one.query : one.train, m = forward() ? one.train : one.query;
    matches_.push_back({t,
                        m,
                        {sides.templ.xy_px(t, 0), sides.templ.xy_px(t, 1)},
                        {sides.image.xy_px(m, 0), sides.image.xy_px(m, 1)},
                        one.distance,
                        one.distance / one.second_distance});
  }
  std::sort(matches_.begin(), matches_.end(), [](const Match& a, const Match& b) {
    return std::pair(a.template_keypoint, a.image_keypoint) <
           std::pair(b.template_keypoint, b.image_keypoint);
  });
}

Result<Correspondences> RatioMatching::answer(const Sides& sides,
                                              const std::vector<Neighbours>& found) {
  collect(sides, found);
  if (one_to_one_) keep_one_per_image_point(matches_);
  merge_duplicates(duplicate_radius_px_, matches_);
  if (matches_.empty()) {
    return no_result("0 matches: none of " + std::to_string(sides.templ.count()) +
                     " template keypoints passed the tests against " +
                     std::to_string(sides.image.count()) + " image keypoints");
  }
  return correspondences(matches_, sides.templ, sides.image);
}

}  // namespace weft::matchers
