// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/statistics.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/shape_evidence.hpp>
#include <weft/sdk/matcher.hpp>

#include "common/view/blur.hpp"
#include "common/view/coarse_search.hpp"
#include "common/view/inputs.hpp"
#include "common/view/picture.hpp"
#include "common/view/predicted_view.hpp"
#include "common/workers/sharing.hpp"
#include "flow_grid.hpp"
#include "likeness.hpp"

namespace weft::dense_flow {
namespace {

constexpr double kSameCorrelation = 0.01;
// Residuals of neighbouring pixels resemble each other: three know as much as one would alone.
constexpr double kPixelsAlike = 3.0;
// How gradually the confidence falls around `max_unlike`.
constexpr double kUnlikeSpread = 0.015;

std::string percent(double share) { return std::to_string(std::lround(100.0 * share)) + " %"; }

std::string tenths(double value) {
  const long scaled = std::lround(10.0 * value);
  return std::to_string(scaled / 10) + "." + std::to_string(std::abs(scaled % 10));
}

/// Draws the texture on a shape that is nearly right and finds how each piece of it moved.
class DenseFlow final : public Matcher {
 public:
  static constexpr About kAbout{
      .reference =
          "own: Kroeger et al., Fast optical flow using dense inverse search, ECCV 2016; Baker and "
          "Matthews, Lucas-Kanade 20 years on: a unifying framework, IJCV 2004",
      .needs = "image template camera",
      .reads = "shape previous.shape correspondences"};

  explicit DenseFlow(Params& p) {
    p.read("spacing_px", options_.spacing_px, "px", {2, 64},
           "distance between matches, in the image after `halvings`");
    p.read("halvings", halvings_, "", {0, 2},
           "number of times that the image is halved first; 1 takes a quarter of the time");
    p.read("search_px", search_px_, "px", {0, 400},
           "maximum displacement of the whole surface from the shape");
    p.read("max_blur_px", max_blur_px_, "px", {0, 100},
           "maximum standard deviation of the blur of the image that the rendered texture copies; "
           "0: none");
    p.prominent().read(
        "min_correlation", options_.min_correlation, "", {0, 1},
        "minimum normalised correlation of image and rendered texture of a kept match");
    p.read("max_round_trip_px", options_.max_round_trip_px, "px", {0.01, 100},
           "maximum forward-backward error of a kept match");
    p.read("max_deviation_px", options_.max_deviation_px, "px", {0.1, 1000},
           "maximum difference of a kept match's displacement from the median of its neighbours");
    p.read("min_share", min_share_, "", {0, 1},
           "minimum share of textured places that are found for a result");
    p.read("max_disagreement_px", max_disagreement_px_, "px", {0.1, 1000},
           "median distance from the other matches at which there is no result");
    p.read("max_unlike", max_unlike_, "", {0.001, 1},
           "share of the texture's contrast missing from the predicted places at which the "
           "matches' confidence is 1/2; contrast under a smooth occluder counts a fifth");
    p.read("min_matches", min_matches_, "", {1, 10000}, "minimum number of matches for a result");
    view_.emplace(halvings_, true);
  }

  Result<void> prepare(const PrepareInput& in) override { return load(in.templ); }

  Result<Correspondences> match(const MatcherInput& in) override {
    if (!in.image || !in.templ || !in.camera) return no_result("there is no image");
    const Shape* shape = in.shape ? &*in.shape : in.previous_shape ? &*in.previous_shape : nullptr;
    if (shape == nullptr) return no_result("there is no shape to begin with");
    const auto fits = view::check_frame(*in.image, *in.camera, *in.templ, *shape, "the shape");
    if (!fits) return fits.error();
    if (shape->shape_state() == ShapeState::lost) return no_result("the shape is lost");
    if (auto ready = load(*in.templ); !ready) return ready.error();
    if (!see(*in.image, *in.camera, *shape, in.call.threads())) {
      return no_result("the shape shows nothing of the texture in the image");
    }
    const view::CoarseShift shift = search_.find(*view_, image_, search_px_);
    blur_px_ = 0.0;
    if (max_blur_px_ > 0.0) {
      blur_px_ =
          view::blur_of_image(*view_, image_, std::max(halvings_, 1), shift.by_px(), max_blur_px_);
      view_->blur(blur_px_);
    }
    grid_.find(*view_, image_, shift.by_px(), options_, workers_, in.call.threads());
    return answer(in.correspondences, shift.by_px());
  }

 private:
  /// Once for a template.
  Result<void> load(const Template& templ) {
    if (templ.revision != 0 && templ.revision == loaded_) return {};
    loaded_ = 0;
    if (auto large = view::check_texture(templ); !large) return large;
    view_->load(templ);
    flat_px_ = templ.flat_px.matrix<2>();
    faces_ = templ.faces.matrix<3>();
    texture_px_ << static_cast<double>(templ.texture.dim(1)),
        static_cast<double>(templ.texture.dim(0));
    loaded_ = templ.revision;
    return {};
  }

  /// Renders the shape and takes the image; false if nothing of the shape is in the image.
  bool see(const Image& image, const Camera& camera, const Shape& shape, int threads) {
    constexpr int kRender = 0, kBoth = 2;
    bool is_drawn = false;
    share_out(workers_, {kBoth, 1, threads}, [&](int, int part, int) {
      if (part == kRender) {
        is_drawn = view_->draw(camera, shape.vertices_m.matrix<3>());
      } else {
        image_.load(image.pixels);
      }
      return true;
    });
    return is_drawn;
  }

  struct Tally {
    std::array<std::int64_t, kFates> fates{};
    double correlation_before = 0.0, correlation = 0.0;  ///< sums over what was found
    std::int64_t of(Fate fate) const { return fates[to_index(static_cast<int>(fate))]; }
    /// Places that show a texture which could be found.
    std::int64_t in_sight() const {
      return of(Fate::unlike) + of(Fate::one_way) + of(Fate::astray) + of(Fate::found);
    }
  };

  Tally count() const {
    Tally tally;
    for (int row = 0; row < grid_.rows(); ++row) {
      for (int column = 0; column < grid_.columns(); ++column) {
        const Node& node = grid_.node(column, row);
        ++tally.fates[to_index(static_cast<int>(node.fate))];
        if (node.fate != Fate::found) continue;
        tally.correlation_before += static_cast<double>(node.correlation_before);
        tally.correlation += static_cast<double>(node.correlation);
      }
    }
    return tally;
  }

  Result<Correspondences> answer(const std::vector<Correspondences>& others,
                                 const Eigen::Vector2d& shift_px) {
    const Tally tally = count();
    const std::int64_t found = tally.of(Fate::found), in_sight = tally.in_sight();
    const std::string of =
        std::to_string(found) + " of " + std::to_string(in_sight) + " places are found";
    if (found < min_matches_) return no_result(of);
    const double share = static_cast<double>(found) / static_cast<double>(in_sight);
    if (share < min_share_) {
      return no_result("too far from the shape: " + of + ", less than " + percent(min_share_));
    }
    const double before = tally.correlation_before / static_cast<double>(found);
    const double after = tally.correlation / static_cast<double>(found);
    if (after < before - kSameCorrelation) {
      return no_result("the image looks more like the shape as it is than like what was found");
    }
    const std::optional<double> off_px = disagreement_px(others);
    if (off_px && *off_px > max_disagreement_px_) {
      return no_result("the other matches are " + tenths(*off_px) + " px off in the median");
    }
    Correspondences matches = collect(found);
    matches.diag.set("share", share);
    matches.diag.set("correlation_before", before);
    matches.diag.set("correlation", after);
    if (max_blur_px_ > 0.0) matches.diag.set("blur_px", blur_px_);
    matches.diag.set("hidden", static_cast<double>(tally.of(Fate::hidden)));
    matches.diag.set("flat", static_cast<double>(tally.of(Fate::flat)));
    matches.diag.set("unlike", static_cast<double>(tally.of(Fate::unlike)));
    matches.diag.set("one_way", static_cast<double>(tally.of(Fate::one_way)));
    matches.diag.set("astray", static_cast<double>(tally.of(Fate::astray)));
    if (off_px) matches.diag.set("disagreement_px", *off_px);
    const double unlike = likeness_.unlike_share(
        view_->level(halvings_), halvings_, image_.level(halvings_), shift_px / scale(), flat_px_,
        [&](std::int32_t face) { return view_->texel_map(face); });
    const bool is_texture = shows_texture_itself(matches);
    matches.confidence =
        make_scalar(is_texture ? 0.0 : logistic((max_unlike_ - unlike) / kUnlikeSpread));
    matches.diag.set("unlike_contrast", unlike);
    matches.diag.set("is_texture", is_texture ? 1.0 : 0.0);
    return matches;
  }

  /// True if the image is the texture and not a view of the object. Matches then have the same
  /// places in both, as in no view of a surface.
  bool shows_texture_itself(const Correspondences& matches) const {
    constexpr double kSame = 0.002;  // share of the width and of the height
    const view::Picture& image = image_.level(0);
    const Eigen::Array2d image_px(image.width, image.height);
    double off = 0.0;
    for (std::int64_t i = 0; i < matches.count(); ++i) {
      const Eigen::Array2d seen =
          (matches.image_px.matrix<2>().row(i).transpose().array() + 0.5) / image_px;
      const Eigen::Array2d drawn =
          (matches.template_px.matrix<2>().row(i).transpose().array() + 0.5) / texture_px_;
      off += (seen - drawn).abs().maxCoeff();
    }
    return off <= kSame * static_cast<double>(matches.count());
  }

  double scale() const { return static_cast<double>(1 << halvings_); }
  /// From px of the grid's level to those of the image.
  Eigen::Vector2d to_image(const Eigen::Vector2d& place) const {
    return (scale() * (place.array() + 0.5) - 0.5).matrix();
  }

  /// Median distance [px] of kept matches from their places by the flow; nothing where too few can
  /// be compared.
  std::optional<double> disagreement_px(const std::vector<Correspondences>& others) {
    constexpr std::size_t kFewest = 8;
    distances_px_.clear();
    for (const Correspondences& matches : others) {
      for (std::int64_t i = 0; i < matches.count(); ++i) {
        if (matches.kept(i) == 0 || matches.face(i) < 0) continue;
        const Eigen::Vector3d weights = matches.barycentrics.matrix<3>().row(i);
        const Eigen::Vector2d expected_px = view_->place_px(matches.face(i), weights);
        const Node* node = grid_.nearest_found({view::at_level(expected_px.x(), halvings_),
                                                view::at_level(expected_px.y(), halvings_)});
        if (node == nullptr) continue;
        const Eigen::Vector2d place_px = expected_px + scale() * node->by_px.cast<double>();
        const Eigen::Vector2d seen_px = matches.image_px.matrix<2>().row(i);
        distances_px_.push_back((seen_px - place_px).norm());
      }
    }
    if (distances_px_.size() < kFewest) return std::nullopt;
    return median_in_place(distances_px_);
  }

  /// The texel that a node of the grid shows; its face must have been rendered.
  Eigen::RowVector2d texel_of(std::int32_t face, const Eigen::Vector3d& weights) const {
    Eigen::RowVector2d texel = Eigen::RowVector2d::Zero();
    for (int k = 0; k < 3; ++k) texel += weights[k] * flat_px_.row(faces_(face, k));
    return texel;
  }

  std::int32_t face_at(const Eigen::Vector2i& place) const {
    const view::ViewLevel& drawn = view_->level(halvings_);
    return drawn.face[to_index(place.y() - drawn.y0) * to_index(drawn.grey.width) +
                      to_index(place.x() - drawn.x0)];
  }

  Correspondences collect(std::int64_t most) const {
    Correspondences out;
    out.template_px = Array<double>({most, 2});
    out.image_px = Array<double>({most, 2});
    out.face = Array<std::int32_t>({most});
    out.barycentrics = Array<double>({most, 3});
    out.kept = Array<std::uint8_t>({most});
    out.score = Array<double>({most});
    out.covariance_px2 = Array<double>({most, 2, 2});
    // A patch's pixels are used by several nodes, which know no more than one of them does.
    const double uses =
        std::max(1.0, static_cast<double>(view::Patch::kSize) /
                          static_cast<double>(options_.spacing_px * options_.spacing_px));
    std::int64_t n = 0;
    for (int row = 0; row < grid_.rows(); ++row) {
      for (int column = 0; column < grid_.columns(); ++column) {
        const Node& node = grid_.node(column, row);
        if (node.fate != Fate::found) continue;
        const Eigen::Vector2i place = grid_.place_px(column, row);
        const std::int32_t face = face_at(place);
        const Eigen::Vector2d place_px = to_image(place.cast<double>());
        const Eigen::Vector3d weights = view_->weights_at(face, place_px);
        const Eigen::Vector2d seen_px = place_px + scale() * node.by_px.cast<double>();
        out.template_px.matrix<2>().row(n) = texel_of(face, weights);
        out.image_px.matrix<2>().row(n) = seen_px.transpose();
        out.face(n) = face;
        out.barycentrics.matrix<3>().row(n) = weights.transpose();
        out.kept(n) = 1;
        out.score(n) = static_cast<double>(node.correlation);
        const Eigen::Matrix2d covariance =
            scale() * scale() * kPixelsAlike * uses * node.covariance_px2.cast<double>();
        for (int k = 0; k < 4; ++k) out.covariance_px2.row(n)[k] = covariance(k / 2, k % 2);
        ++n;
      }
    }
    return out;
  }

  FlowOptions options_;
  int halvings_ = 0;
  double search_px_ = 16.0;
  double max_blur_px_ = 0.0;
  double min_share_ = 0.3;
  double max_disagreement_px_ = 3.0;
  double max_unlike_ = 0.095;
  int min_matches_ = 50;

  double blur_px_ = 0.0;  ///< blur of the current frame
  std::uint64_t loaded_ = 0;
  Points2 flat_px_;
  Faces faces_;
  Eigen::Array2d texture_px_;  ///< [px] width and height
  std::optional<view::PredictedView> view_;
  view::Pyramid image_;
  view::CoarseSearch search_;
  FlowGrid grid_;
  Likeness likeness_;
  Workers workers_;
  std::vector<double> distances_px_;
};

}  // namespace
}  // namespace weft::dense_flow

WEFT_PLUGIN(weft::dense_flow::DenseFlow, "matchers/dense_flow", "1.1.0",
            "Finds every patch of the texture near an approximately correct shape.")
