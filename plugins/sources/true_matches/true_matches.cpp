// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>
#include <weft/data/matrix.hpp>
#include <weft/geometry/camera_model.hpp>
#include <weft/sdk/source.hpp>
#include <weft/truth/truth_map.hpp>

#include "common/scene/random_stream.hpp"
#include "cover.hpp"

namespace weft::true_matches {
namespace {

/// Purposes of random streams.
constexpr std::uint64_t kCover = 1, kMatches = 2;

/// A sampled match: its place on the template and in the image, without and with noise.
struct Drawn {
  Eigen::Vector2d xy_m;      ///< [2] m, template
  Eigen::Vector2d true_px;   ///< [2] px
  Eigen::Vector2d image_px;  ///< [2] px
};

/// Where matches are on the template.
enum class Places { drawn, true_points };

/// The host finds pixel and face of the template from template_xy_m.
Correspondences matches_of(const std::vector<Drawn>& drawn) {
  const auto count = static_cast<std::int64_t>(drawn.size());
  Correspondences matches;
  matches.template_px = Array<double>({count, 2}, 0.0);
  matches.template_xy_m = Array<double>({count, 2});
  matches.image_px = Array<double>({count, 2});
  matches.face = Array<std::int32_t>({count}, -1);
  matches.barycentrics = Array<double>({count, 3}, 0.0);
  matches.kept = Array<std::uint8_t>({count}, 1);
  matches.score = Array<double>({count}, 1.0);
  for (std::int64_t n = 0; n < count; ++n) {
    matches.template_xy_m.matrix<2>().row(n) = drawn[to_index(n)].xy_m;
    matches.image_px.matrix<2>().row(n) = drawn[to_index(n)].image_px;
  }
  return matches;
}

/// Samples matches on the true surface of another source, with the number, noise and gaps of its
/// parameters. It may also report another camera than that of the frames.
class TrueMatches final : public Source {
 public:
  static constexpr About kAbout{
      .reference = "own: Shetab-Bushehri et al. 2023, ROBUSfT, Section VI (inliers)",
      .produces = "image time correspondences ground_truth",
      .uses_truth = true};

  explicit TrueMatches(Params& p) {
    p.component("frames", frames_, "source of the frames and of their ground truth");
    p.choice("places", places_, {{"drawn", Places::drawn}, {"true_points", Places::true_points}},
             "positions of the matches; drawn: evenly over the surface; true_points: one match at "
             "each true point");
    p.read("matches", matches_, "", {0, 100000},
           "number of matches per frame, evenly over the visible surface; for drawn");
    p.read("noise_px", noise_px_, "px", {0.0, 1000.0},
           "standard deviation, along u and v, of the image points");
    p.read("covered", covered_, "", {0.0, 1.0},
           "share of the object that a grey occluder covers, from one side");
    p.read("focal_error", focal_error_, "", {-0.9, 10.0},
           "reported focal length divided by the true one, minus 1");
    p.read("center_error_px", center_error_px_, "px", {-10000.0, 10000.0},
           "reported principal point minus the true one, along u and along v");
    p.read("seed", seed_, "", {0, 9e15},
           "seed of matches, noise and covered side, independent of the run's seed");
  }

  Result<Camera> open(const Call& call) override {
    auto camera = frames_.open(call);
    if (!camera) return camera.error();
    const auto count = frames_.count(call);
    if (!count) return count.error();
    frame_count_ = *count;
    camera_ = *camera;
    Camera stated = camera_;
    stated.fx *= 1.0 + focal_error_;
    stated.fy *= 1.0 + focal_error_;
    stated.cx += center_error_px_;
    stated.cy += center_error_px_;
    return stated;
  }

  std::int64_t count() const override { return frame_count_.frames; }
  bool live() const override { return frame_count_.live != 0; }

  Result<SourceFrame> read(std::int64_t index, const Call& call) override {
    auto given = frames_.read(call);
    if (!given) return given.error();
    const std::string reason = given.degenerate_reason();
    SourceFrame frame = *std::move(given);
    frame.correspondences.reset();
    if (frame.ground_truth && frame.ground_truth->count() > 0) {
      const auto status = draw(frame, static_cast<std::uint64_t>(index));
      if (!status) return status.error();
    }
    if (!reason.empty()) return degenerate(std::move(frame), reason);
    return frame;
  }

 private:
  /// Lays the cover over the frame, and draws matches where it does not lie.
  Result<void> draw(SourceFrame& frame, std::uint64_t index) const {
    GroundTruth& truth = *frame.ground_truth;
    const auto map = TruthMap::create(truth);
    if (!map) return map.error();
    Rng side = stream(kCover, 0);
    const Cover cover(truth, covered_, side);
    Rng rng = stream(kMatches, index);
    const std::vector<Drawn> drawn = places_ == Places::drawn
                                         ? draw_matches(truth, *map, cover, rng)
                                         : matches_at_true_points(truth, cover, rng);
    frame.correspondences = matches_of(drawn);
    truth.match_label = {};
    truth.match_xy_px = Array<double>({static_cast<std::int64_t>(drawn.size()), 2});
    for (std::size_t n = 0; n < drawn.size(); ++n) {
      truth.match_xy_px.matrix<2>().row(static_cast<Eigen::Index>(n)) = drawn[n].true_px;
    }
    if (covered_ > 0.0) cover.hide(truth, frame.image);
    return {};
  }

  /// Points uniform over the box of the template; those beside the surface, hidden, covered or
  /// outside the image are sampled again. The first n are the same whatever the number of matches.
  std::vector<Drawn> draw_matches(const GroundTruth& truth, const TruthMap& map, const Cover& cover,
                                  Rng& rng) const {
    constexpr std::int64_t kDrawsPerMatch = 200;  // a visible share of 1/200 is still found
    const auto flat_m = truth.template_xy_m.matrix<2>();
    const Eigen::Vector2d low = flat_m.colwise().minCoeff(), high = flat_m.colwise().maxCoeff();
    const Pinhole pinhole{camera_.fx, camera_.fy, camera_.cx, camera_.cy};
    std::vector<Drawn> drawn;
    for (std::int64_t left = kDrawsPerMatch * matches_;
         left > 0 && static_cast<std::int64_t>(drawn.size()) < matches_; --left) {
      const double x_m = rng.uniform(low.x(), high.x()), y_m = rng.uniform(low.y(), high.y());
      const Eigen::Vector2d error(rng.normal(), rng.normal());
      if (cover.over({x_m, y_m})) continue;
      const auto place = map.at({x_m, y_m});
      if (!place || place->hidden || !(place->point_m.z() > 0.0)) continue;
      const Eigen::Vector2d true_px = project(pinhole, place->point_m);
      const Eigen::Vector2d image_px = true_px + noise_px_ * error;
      if (!camera_.shows(true_px.x(), true_px.y())) continue;
      drawn.push_back({{x_m, y_m}, true_px, image_px});
    }
    return drawn;
  }

  /// One at each true point that is visible, not covered and in the image.
  std::vector<Drawn> matches_at_true_points(const GroundTruth& truth, const Cover& cover,
                                            Rng& rng) const {
    const Pinhole pinhole{camera_.fx, camera_.fy, camera_.cx, camera_.cy};
    std::vector<Drawn> drawn;
    for (std::int64_t t = 0; t < truth.count(); ++t) {
      const Eigen::Vector2d error(rng.normal(), rng.normal());
      const Eigen::Vector2d xy_m = truth.template_xy_m.matrix<2>().row(t).transpose();
      const Eigen::Vector3d point_m = truth.points_m.matrix<3>().row(t).transpose();
      const bool hidden = truth.visible.present() && truth.visible(t) == 0;
      if (hidden || cover.over(xy_m) || !(point_m.z() > 0.0)) continue;
      const Eigen::Vector2d true_px = project(pinhole, point_m);
      if (!camera_.shows(true_px.x(), true_px.y())) continue;
      drawn.push_back({xy_m, true_px, true_px + noise_px_ * error});
    }
    return drawn;
  }

  Rng stream(std::uint64_t purpose, std::uint64_t frame) const {
    return scene::random_stream(static_cast<std::uint64_t>(seed_), purpose, frame);
  }

  SourceComponent frames_{"sources/frex"};
  Places places_ = Places::drawn;
  std::int64_t matches_ = 300;
  double noise_px_ = 0.0;
  double covered_ = 0.0;
  double focal_error_ = 0.0;
  double center_error_px_ = 0.0;
  std::int64_t seed_ = 1;

  Count frame_count_;
  Camera camera_{};  ///< that took the frames
};

}  // namespace
}  // namespace weft::true_matches

using weft::true_matches::TrueMatches;
WEFT_PLUGIN(TrueMatches, "sources/true_matches", "1.1.0",
            "Draws matches on the true surface of another source; for experiments only.")
