// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <weft/core/index.hpp>
#include <weft/data/matrix.hpp>
#include <weft/sdk/matcher.hpp>

#include "common/view/inputs.hpp"
#include "tracker.hpp"

namespace weft::track {
namespace {

std::string percent(double share) { return std::to_string(std::lround(100.0 * share)) + " %"; }

/// Searches for the points of the texture near their projections by the previous shape.
class Track final : public Matcher {
 public:
  static constexpr About kAbout{
      .reference =
          "paper: Baker and Matthews, Lucas-Kanade 20 years on: a unifying framework, IJCV 2004; "
          "Shi and Tomasi, Good features to track, CVPR 1994",
      .needs = "image template camera previous.shape",
      .reads = "previous.correspondences"};

  explicit Track(Params& p) {
    p.prominent().read(
        "max_points", max_points_, "", {16, 10000},
        "approximate number of tracked points: one per cell of a grid over the surface");
    p.read("search_px", options_.search_px, "px", {0, 400},
           "maximum movement of the whole surface since the previous frame");
    p.read("min_correlation", options_.min_correlation, "", {0, 1},
           "minimum normalised correlation of image and patch of a kept point");
    p.read("max_deviation_px", options_.max_deviation_px, "px", {0.1, 1000},
           "maximum distance of a kept point from an affine motion fitted to all points");
    p.read("min_share", min_share_, "", {0, 1},
           "minimum share of the expected visible points that are found; below it the result is "
           "degenerate");
    p.read("max_change", max_change_, "", {0, 10},
           "maximum rotation, growth or shear of the surface in the image; above it the result is "
           "degenerate");
    p.read("min_matches", min_matches_, "", {1, 10000}, "minimum number of matches for a result");
    p.read("min_confidence", min_confidence_, "", {0, 1},
           "minimum confidence of the previous shape; below it the result is degenerate");
  }

  Result<void> prepare(const PrepareInput& in) override { return load(in.templ, in.camera); }

  Result<Correspondences> match(const MatcherInput& in) override {
    if (!in.image || !in.templ || !in.camera || !in.previous_shape) {
      return no_result("there is no shape of an earlier frame to begin with");
    }
    const Shape& shape = *in.previous_shape;
    const auto fits =
        view::check_frame(*in.image, *in.camera, *in.templ, shape, "the previous shape");
    if (!fits) return fits.error();
    if (shape.shape_state() == ShapeState::lost) return no_result("the previous shape is lost");
    if (auto ready = load(*in.templ, *in.camera); !ready) return ready.error();
    if (!view_.draw(*in.camera, shape.vertices_m.matrix<3>())) {
      return no_result("the previous shape shows nothing of the texture in the image");
    }
    image_.load(in.image->pixels);
    choose_targets(in.previous_correspondences);
    tracker_.find(view_, image_, options_, std::max(in.call.threads(), 1), targets_);
    return answer(shape);
  }

 private:
  /// Once for a template and a camera.
  Result<void> load(const Template& templ, const Camera& camera) {
    const std::array<std::uint64_t, 3> key{templ.revision,
                                           static_cast<std::uint64_t>(camera.width_px),
                                           static_cast<std::uint64_t>(camera.height_px)};
    if (templ.revision != 0 && key == loaded_) return {};
    loaded_ = {};
    if (auto large = view::check_texture(templ); !large) return large;
    view_.load(templ);
    auto points = points_.load(templ, camera, max_points_);
    if (points) loaded_ = key;
    return points;
  }

  /// In each cell the best match of the previous frame, else the best point of the texture.
  void choose_targets(const std::optional<Correspondences>& previous) {
    best_.assign(to_index(points_.cells()), -1);
    if (previous) {
      for (std::int64_t i = 0; i < previous->count(); ++i) {
        if (previous->kept(i) == 0 || previous->face(i) < 0) continue;
        std::int64_t& best = best_[to_index(points_.cell_of(place(*previous, i)))];
        if (best < 0 || previous->score(i) > previous->score(best)) best = i;
      }
    }
    targets_.clear();
    for (int cell = 0; cell < points_.cells(); ++cell) {
      const std::int64_t match = best_[to_index(cell)];
      if (match >= 0) {
        const Eigen::Vector3d weights = previous->barycentrics.matrix<3>().row(match);
        targets_.push_back({{place(*previous, match), previous->face(match), weights}, false});
      } else if (points_.point(cell).face >= 0) {
        targets_.push_back({points_.point(cell), true});
      }
    }
  }

  static Eigen::Vector2d place(const Correspondences& matches, std::int64_t i) {
    return matches.template_px.matrix<2>().row(i);
  }

  Result<Correspondences> answer(const Shape& shape) const {
    std::array<std::int64_t, kFates> fates{};
    std::int64_t refilled = 0;
    for (const Target& target : targets_) {
      ++fates[to_index(static_cast<int>(target.fate))];
      refilled += target.fate == Fate::found && target.is_refill ? 1 : 0;
    }
    const auto number = [&](Fate fate) { return fates[to_index(static_cast<int>(fate))]; };
    const std::int64_t found = number(Fate::found);
    const std::int64_t in_sight =
        static_cast<std::int64_t>(targets_.size()) - number(Fate::hidden) - number(Fate::flat);
    const std::string of = std::to_string(found) + " of " + std::to_string(in_sight) + " points";
    if (found < min_matches_) return no_result(of + " found again");
    Correspondences matches = collect(found);
    const auto count = [&](const char* name, std::int64_t value) {
      matches.diag.set(name, static_cast<double>(value));
    };
    count("followed", found - refilled);
    count("refilled", refilled);
    count("hidden", number(Fate::hidden));
    count("flat", number(Fate::flat));
    count("unlike", number(Fate::unlike));
    count("uncertain", number(Fate::uncertain));
    count("astray", number(Fate::astray));
    matches.diag.set("change", tracker_.change());
    matches.diag.set("sheet_correlation", tracker_.shift().correlation);
    const std::string doubt =
        doubt_in(shape, static_cast<double>(found) / static_cast<double>(in_sight), of);
    if (!doubt.empty()) return degenerate(std::move(matches), doubt);
    return matches;
  }

  /// Why the matches should not be relied on alone; empty where they may be.
  std::string doubt_in(const Shape& shape, double share, const std::string& of) const {
    if (share < min_share_) return "weak: " + of + " found again, less than " + percent(min_share_);
    if (tracker_.change() > max_change_) {
      return "weak: the surface turned, grew or sheared by " + percent(tracker_.change());
    }
    if (shape.shape_state() != ShapeState::estimated) {
      return std::string("weak: the previous shape is ") + to_string(shape.shape_state());
    }
    if (shape.confidence < min_confidence_) {
      return "weak: the previous shape has a confidence of " + percent(shape.confidence);
    }
    return {};
  }

  Correspondences collect(std::int64_t count) const {
    Correspondences out;
    out.template_px = Array<double>({count, 2});
    out.image_px = Array<double>({count, 2});
    out.face = Array<std::int32_t>({count});
    out.barycentrics = Array<double>({count, 3});
    out.scale_ratio = Array<double>({count});
    out.angle_difference_rad = Array<double>({count});
    out.kept = Array<std::uint8_t>({count});
    out.score = Array<double>({count});
    std::int64_t n = 0;
    for (const Target& target : targets_) {
      if (target.fate != Fate::found) continue;
      const Eigen::Matrix2d jacobian = view_.jacobian(target.point.face);
      out.template_px.matrix<2>().row(n) = target.point.template_px.transpose();
      out.image_px.matrix<2>().row(n) = (target.expected_px + target.by_px).transpose();
      out.face(n) = target.point.face;
      out.barycentrics.matrix<3>().row(n) = target.point.weights.transpose();
      out.scale_ratio(n) = std::sqrt(std::abs(jacobian.determinant()));
      out.angle_difference_rad(n) =
          std::atan2(jacobian(1, 0) - jacobian(0, 1), jacobian(0, 0) + jacobian(1, 1));
      out.kept(n) = 1;
      out.score(n) = target.correlation;
      ++n;
    }
    return out;
  }

  int max_points_ = 300;
  TrackerOptions options_;
  double min_share_ = 0.5;
  double max_change_ = 0.08;
  int min_matches_ = 16;
  double min_confidence_ = 0.5;

  std::array<std::uint64_t, 3> loaded_{};
  TexturePoints points_;
  view::PredictedView view_{kFinestDrawn};
  view::Pyramid image_;
  Tracker tracker_;
  std::vector<std::int64_t> best_;  ///< by cell, the match of the previous frame, -1 for none
  std::vector<Target> targets_;
};

}  // namespace
}  // namespace weft::track

WEFT_PLUGIN(weft::track::Track, "matchers/track", "1.0.1",
            "Tracks points of the texture from the previous shape into the image.")
