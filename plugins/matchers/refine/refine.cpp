// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <string>
#include <utility>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/statistics.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/data/matrix.hpp>
#include <weft/sdk/matcher.hpp>

#include "alignment.hpp"
#include "common/view/inputs.hpp"
#include "common/view/picture.hpp"
#include "common/view/predicted_view.hpp"

namespace weft::refine {
namespace {

/// Moves kept matches to where the texture itself is seen, to a fraction of a pixel.
class Refine final : public Matcher {
 public:
  static constexpr About kAbout{
      .reference =
          "paper: Baker and Matthews, Lucas-Kanade 20 years on: a unifying framework, IJCV 2004",
      .needs = "image template camera correspondences",
      .reads = "shape previous.shape"};

  explicit Refine(Params& p) {
    p.read("min_correlation", options_.min_correlation, "", {0, 1},
           "minimum normalised correlation of image and rendered texture for a match to move");
    p.read("max_step_px", options_.max_step_px, "px", {0.01, 6},
           "maximum step of a match; a match with a larger step stays unchanged");
    p.read("unrefined_noise_px", unrefined_noise_px_, "px", {0.001, 100},
           "standard deviation, along u and v, of an unchanged match");
  }

  Result<void> prepare(const PrepareInput& in) override { return load(in.templ); }

  Result<Correspondences> match(const MatcherInput& in) override {
    if (!in.image || !in.templ || !in.camera || in.correspondences.empty()) {
      return no_result("there is no image, or there are no matches");
    }
    if (in.correspondences.size() > 1) {
      return Error{Errc::invalid_data,
                   "takes one set of matches: unite them by matchers/merge first"};
    }
    const Correspondences& matches = in.correspondences.front();
    const Shape* shape = in.shape ? &*in.shape : in.previous_shape ? &*in.previous_shape : nullptr;
    if (matches.count() == 0) return no_result("there are no matches");
    if (shape == nullptr) return as_it_came(matches, "there is no shape");
    const auto fits = view::check_frame(*in.image, *in.camera, *in.templ, *shape, "the shape");
    if (!fits) return fits.error();
    if (auto valid = check(matches, *in.templ); !valid) return valid.error();
    if (shape->shape_state() == ShapeState::lost) return as_it_came(matches, "the shape is lost");
    if (auto ready = load(*in.templ); !ready) return ready.error();
    if (!view_.draw(*in.camera, shape->vertices_m.matrix<3>())) {
      return as_it_came(matches, "the shape shows nothing of the texture in the image");
    }
    view::read_grey(in.image->pixels, image_);
    return refined(matches);
  }

 private:
  /// Once for a template.
  Result<void> load(const Template& templ) {
    if (templ.revision != 0 && templ.revision == loaded_) return {};
    loaded_ = 0;
    if (auto large = view::check_texture(templ); !large) return large;
    view_.load(templ);
    loaded_ = templ.revision;
    return {};
  }

  static Result<void> check(const Correspondences& matches, const Template& templ) {
    for (std::int64_t i = 0; i < matches.count(); ++i) {
      const std::string match = "match " + std::to_string(i);
      if (matches.face(i) >= templ.faces.rows()) {
        return Error{Errc::invalid_data,
                     match + " lies in face " + std::to_string(matches.face(i)) +
                         ", which the template does not have: use one template"};
      }
      const bool finite = matches.image_px.matrix<2>().row(i).allFinite() &&
                          matches.barycentrics.matrix<3>().row(i).allFinite();
      if (!finite) return Error{Errc::invalid_data, match + " is not finite: leave it out"};
    }
    return {};
  }

  /// Later stages have no fewer matches than without this stage.
  static Result<Correspondences> as_it_came(Correspondences matches, const std::string& why) {
    matches.diag = {};  // diagnostics of its matcher alone
    return degenerate(std::move(matches), "the matches as they came: " + why);
  }

  Result<Correspondences> refined(const Correspondences& matches) {
    const std::int64_t count = matches.count();
    Correspondences out = matches;
    out.diag = {};
    out.image_px = Array<double>({count, 2});
    out.covariance_px2 = Array<double>({count, 2, 2});
    std::array<std::int64_t, kFates> fates{};
    steps_px_.clear();
    for (std::int64_t i = 0; i < count; ++i) {
      worked(50);
      Eigen::Vector2d place_px = matches.image_px.matrix<2>().row(i);
      Eigen::Matrix2d covariance_px2 =
          unrefined_noise_px_ * unrefined_noise_px_ * Eigen::Matrix2d::Identity();
      if (matches.kept(i) != 0 && matches.face(i) >= 0) {
        const Refinement found = refine_match(matches, i);
        ++fates[to_index(static_cast<int>(found.fate))];
        if (found.fate == Fate::refined) {
          steps_px_.push_back((found.seen_px - place_px).norm());
          place_px = found.seen_px;
          covariance_px2 = found.covariance_px2;
        }
      }
      out.image_px.matrix<2>().row(i) = place_px.transpose();
      for (int k = 0; k < 4; ++k) out.covariance_px2.row(i)[k] = covariance_px2(k / 2, k % 2);
    }
    constexpr std::array<const char*, kFates> kNames{"refined", "hidden", "flat", "unlike", "far"};
    for (std::size_t k = 0; k < kNames.size(); ++k) {
      out.diag.set(kNames[k], static_cast<double>(fates[k]));
    }
    if (!steps_px_.empty()) out.diag.set("step_px", median_in_place(steps_px_));
    return out;
  }

  Refinement refine_match(const Correspondences& matches, std::int64_t i) const {
    const Eigen::Vector3d weights = matches.barycentrics.matrix<3>().row(i);
    const Eigen::Vector2d seen_px = matches.image_px.matrix<2>().row(i);
    return refine(view_, image_, view_.place_px(matches.face(i), weights), seen_px, options_);
  }

  RefineOptions options_;
  double unrefined_noise_px_ = 1.0;

  std::uint64_t loaded_ = 0;
  view::PredictedView view_{0};
  view::Picture image_;
  std::vector<double> steps_px_;
};

}  // namespace
}  // namespace weft::refine

WEFT_PLUGIN(weft::refine::Refine, "matchers/refine", "1.0.0",
            "Refines matches by the texture itself, to a fraction of a pixel.")
