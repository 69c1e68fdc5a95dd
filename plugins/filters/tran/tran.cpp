// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>
#include <weft/core/statistics.hpp>

#include "common/candidates.hpp"
#include "match_plane.hpp"

namespace {

using weft::FilterInput;
using weft::InlierMask;
using weft::filters::Candidates;
using weft::tran::Found;
using weft::tran::MatchPoints;
using weft::tran::Residual;

constexpr int kRefits = 3;
constexpr Eigen::Index kFewAgreeing = 6;
constexpr double kInnerPercent = 10.0;  // percentiles of the coordinates between which the first
                                        // extent lies

/// Keeps the matches near one affine map, within a bound so wide that it holds the bent surface.
class Tran final : public weft::Filter {
 public:
  static constexpr weft::About kAbout{
      .reference = "reconstruction: Tran, Chin, Carneiro, Brown and Suter 2012, ECCV",
      .random = true};
  static constexpr weft::Sweep kSweep{"tau", {0.005, 0.02, 0.04, 0.06, 0.1, 0.2, 0.3, 0.5, 1}};

  explicit Tran(weft::Params& p) {
    p.read("tau", tau_, "", {1e-4, 10},
           "maximum residual of a kept match, relative to the diagonal of the agreeing matches in "
           "the image");
    p.choice("residual", search_.residual,
             {{"orthogonal", Residual::orthogonal}, {"regression", Residual::regression}},
             "residual of a match; orthogonal: distance from the plane in the space of matches; "
             "regression: distance from the map in the image");
    p.read("most_draws", search_.most_draws, "", {1, 1'000'000},
           "maximum number of samples of three matches");
    p.read("keep_orientation", search_.keep_orientation,
           "rejection of maps that turn the back of the surface to the camera");
  }

  weft::Result<InlierMask> filter(const FilterInput& in) override {
    const auto candidates = weft::filters::candidates_of(in.correspondences);
    if (!candidates) return candidates.error();
    if (candidates->count() < 3) {
      return weft::no_result(
          "too few matches for an affine map: " + std::to_string(candidates->count()) + " of 3");
    }
    const weft::filters::Normaliser of_template(candidates->template_px);
    const weft::filters::Normaliser of_image(candidates->image_px);
    MatchPoints matches(candidates->template_px.rows(), 4);
    matches << of_template(candidates->template_px), of_image(candidates->image_px);
    weft::Rng rng = in.call.rng();
    double limit = tau_ * of_image.per_px * first_extent_px(*candidates);
    weft::tran::Search search = search_;
    search.limit = limit;
    auto found = weft::tran::search(matches, search, rng);
    if (!found) {
      return weft::no_result("no three matches make an affine map: they lie on lines or mirror");
    }
    Eigen::ArrayXd distances2;
    found->plane.distances2(matches, distances2);
    std::vector<std::uint8_t> keep = within(distances2, limit);
    for (int i = 0; i < kRefits && count_of(keep) >= 3; ++i) {
      const auto refitted = weft::tran::plane_of(matches, keep, search_.residual);
      if (!refitted) break;
      found->plane = *refitted;
      limit = tau_ * of_image.per_px * extent_px(*candidates, keep);
      found->plane.distances2(matches, distances2);
      keep = within(distances2, limit);
    }
    const Eigen::Index kept = count_of(keep);
    if (kept < kFewAgreeing) {
      return weft::no_result("low consensus: only " + std::to_string(kept) +
                             " matches agree on an affine map");
    }
    return answer(in, *candidates, keep, distances2, limit, *found, of_image.per_px);
  }

 private:
  static std::vector<std::uint8_t> within(const Eigen::ArrayXd& distances2, double limit) {
    std::vector<std::uint8_t> keep;
    for (const double distance2 : distances2) keep.push_back(distance2 < limit * limit ? 1 : 0);
    return keep;
  }

  static Eigen::Index count_of(const std::vector<std::uint8_t>& keep) {
    return std::count(keep.begin(), keep.end(), std::uint8_t{1});
  }

  /// The diagonal without the outer matches, which may be anywhere.
  static double first_extent_px(const Candidates& candidates) {
    Eigen::Vector2d extent_px;
    for (int x = 0; x < 2; ++x) {
      const Eigen::VectorXd column = candidates.image_px.col(x);
      const std::vector<double> values(column.data(), column.data() + column.size());
      extent_px[x] =
          weft::percentile(values, 100.0 - kInnerPercent) - weft::percentile(values, kInnerPercent);
    }
    return extent_px.norm();
  }

  static double extent_px(const Candidates& candidates, const std::vector<std::uint8_t>& keep) {
    Eigen::AlignedBox2d box;
    for (std::size_t k = 0; k < keep.size(); ++k) {
      if (keep[k] != 0) {
        box.extend(candidates.image_px.row(static_cast<Eigen::Index>(k)).transpose());
      }
    }
    return box.diagonal().norm();
  }

  static InlierMask answer(const FilterInput& in, const Candidates& candidates,
                           const std::vector<std::uint8_t>& keep, const Eigen::ArrayXd& distances2,
                           double limit, const Found& found, double per_px) {
    std::vector<double> score;
    for (const double distance2 : distances2) {
      score.push_back(limit > 0.0 ? limit / (limit + std::sqrt(distance2)) : 0.0);
    }
    InlierMask mask = weft::filters::mask_of(in.correspondences, candidates, keep, score);
    mask.diag.set("threshold_px", per_px > 0.0 ? limit / per_px : 0.0);
    mask.diag.set("draws", found.draws);
    return mask;
  }

  double tau_ = 0.1;
  weft::tran::Search search_;
};

}  // namespace

WEFT_PLUGIN(Tran, "filters/tran", "1.1.0",
            "Rejects matches far from the plane that RANSAC finds in the space of matches.")
