// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/data/matrix.hpp>
#include <weft/geometry/face_locator.hpp>
#include <weft/sdk/detector.hpp>
#include <weft/sdk/filter.hpp>
#include <weft/sdk/matcher.hpp>
#include <weft/sdk/source.hpp>

#include "script.hpp"

namespace scripted {

/// Keypoints on a grid of texels, and where the scene shows them in a frame.
class GridDetector final : public weft::Detector {
 public:
  explicit GridDetector(weft::Params& p) : script_(p) {
    p.read("count", count_, "", {0, 10'000}, "keypoints");
    p.read("first_px", first_px_, "px", {0, 1000}, "texel of the first one");
  }

  weft::Result<void> prepare(const weft::PrepareInput&) override { return script_.prepare(); }

  weft::Result<weft::Keypoints> detect(const weft::DetectorInput& in) override {
    if (auto failure = script_.failure(in.call)) return *failure;
    const bool on_template = in.image.stem == "template";
    const std::int64_t count = script_.length(in.call, count_);
    weft::Keypoints points;
    points.xy_px = weft::Array<double>({count, 2}, 0.0);
    points.scale_px = weft::Array<double>({count}, 0.0);
    points.angle_rad = weft::Array<double>({count}, 0.0);
    points.response = weft::Array<double>({count_}, 0.0);
    points.octave = weft::Array<std::int32_t>({count}, 0);
    points.metric = "l2";
    points.descriptors = weft::Array<float>({count, 4}, 0.0F);
    for (std::int64_t k = 0; k < count; ++k) {
      const double u = first_px_ + 15.0 * static_cast<double>(k % 6);
      const double v = first_px_ + 12.0 * static_cast<double>(k / 6);
      points.xy_px(k, 0) = on_template ? u : script_.number(in.call, to_image(u));
      points.xy_px(k, 1) = on_template ? v : to_image(v);
    }
    return script_.answer(in.call, std::move(points));
  }

 private:
  Script script_;
  int count_ = 24;
  double first_px_ = 10.0;
};

inline weft::Correspondences make_matches(std::int64_t count) {
  weft::Correspondences matches;
  matches.template_px = weft::Array<double>({count, 2}, 0.0);
  matches.image_px = weft::Array<double>({count, 2}, 0.0);
  matches.face = weft::Array<std::int32_t>({count}, 0);
  matches.barycentrics = weft::Array<double>({count, 3}, 0.0);
  matches.kept = weft::Array<std::uint8_t>({count}, 0);
  matches.score = weft::Array<double>({count}, 0.0);
  std::fill_n(matches.kept.data(), count, std::uint8_t{1});
  std::fill_n(matches.score.data(), count, 1.0);
  return matches;
}

/// Pairs keypoints of equal index.
class IndexMatcher final : public weft::Matcher {
 public:
  static constexpr weft::About kAbout{.needs = "keypoints template_keypoints"};

  explicit IndexMatcher(weft::Params& p) : script_(p) {}

  weft::Result<weft::Correspondences> match(const weft::MatcherInput& in) override {
    if (auto failure = script_.failure(in.call)) return *failure;
    const weft::Keypoints &image = *in.keypoints, &texture = *in.template_keypoints;
    const std::int64_t count = std::min(image.count(), texture.count());
    weft::Correspondences matches = make_matches(count);
    for (std::int64_t i = 0; i < count; ++i) {
      for (int k = 0; k < 2; ++k) matches.image_px(i, k) = image.xy_px(i, k);
      for (int k = 0; k < 2; ++k) matches.template_px(i, k) = texture.xy_px(i, k);
      for (int k = 0; k < 3; ++k) matches.barycentrics(i, k) = texture.barycentrics(i, k);
      matches.face(i) = texture.face(i);
    }
    return script_.answer(in.call, std::move(matches));
  }

 private:
  Script script_;
};

/// Matches without keypoints, in patterns that hurt.
class PatternMatcher final : public weft::Matcher {
 public:
  explicit PatternMatcher(weft::Params& p) : script_(p) {
    p.read("count", count_, "", {0, 10'000}, "matches");
    p.read("bad_face", bad_face_, "give a face that the template does not have");
    p.read("places_only", places_only_, "leave the faces to the host");
    p.choice("pattern", pattern_,
             {{"grid", Pattern::grid},
              {"collinear", Pattern::collinear},
              {"duplicate", Pattern::duplicate}},
             "where the matches lie");
    p.read("image_scale", image_scale_, "", {0, 100}, "image pixels per texel");
    p.read("image_shift_px", image_shift_px_, "px", {-1e4, 1e4}, "image of texel (0, 0)");
  }

  weft::Result<void> prepare(const weft::PrepareInput& in) override {
    auto locator =
        weft::FaceLocator::create(in.templ.flat_px.matrix<2>(), in.templ.faces.matrix<3>());
    if (!locator) return locator.error();
    locator_ = *std::move(locator);
    extent_ = in.templ.flat_px.matrix<2>().colwise().maxCoeff().transpose();
    return script_.prepare();
  }

  weft::Result<weft::Correspondences> match(const weft::MatcherInput& in) override {
    if (auto failure = script_.failure(in.call)) return *failure;
    weft::Correspondences matches = make_matches(script_.length(in.call, count_));
    for (std::int64_t i = 0; i < matches.count(); ++i) {
      const Eigen::Vector2d texel = place(i);
      const weft::FaceLocation at = locator_->locate(texel);
      for (int k = 0; k < 2; ++k) {
        matches.template_px(i, k) = texel(k);
        matches.image_px(i, k) = script_.number(in.call, image_scale_ * texel(k) + image_shift_px_);
      }
      for (int k = 0; k < 3; ++k) matches.barycentrics(i, k) = at.weights(k);
      matches.face(i) = bad_face_ ? 1'000'000 : at.face;
      if (!places_only_) continue;
      for (int k = 0; k < 3; ++k) matches.barycentrics(i, k) = 0.0;
      matches.face(i) = -1;
    }
    return script_.answer(in.call, std::move(matches));
  }

 private:
  enum class Pattern { grid, collinear, duplicate };

  /// Within the middle four fifths of the texture.
  Eigen::Vector2d place(std::int64_t i) const {
    const auto step = static_cast<double>(i) / std::max(1, count_ - 1);
    if (pattern_ == Pattern::duplicate) return 0.5 * extent_;
    if (pattern_ == Pattern::collinear) return (0.1 + 0.8 * step) * extent_;
    const double golden = 0.6180339887498949 * static_cast<double>(i);
    return {(0.1 + 0.8 * (golden - std::floor(golden))) * extent_.x(),
            (0.1 + 0.8 * step) * extent_.y()};
  }

  Script script_;
  int count_ = 24;
  bool bad_face_ = false, places_only_ = false;
  Pattern pattern_ = Pattern::grid;
  double image_scale_ = kScale;
  double image_shift_px_ = kShift_px;
  std::optional<weft::FaceLocator> locator_;
  Eigen::Vector2d extent_ = Eigen::Vector2d::Zero();
};

/// All matches of several matchers, one behind the other; one that is there to unite them, or one
/// that reads them beside an image.
template <bool kUnites>
class Merger final : public weft::Matcher {
 public:
  static constexpr weft::About kAbout{.reads =
                                          kUnites ? "correspondences" : "image correspondences"};

  explicit Merger(weft::Params&) {}

  weft::Result<weft::Correspondences> match(const weft::MatcherInput& in) override {
    std::int64_t count = 0;
    for (const weft::Correspondences& part : in.correspondences) count += part.count();
    weft::Correspondences all = make_matches(count);
    std::int64_t row = 0;
    for (const weft::Correspondences& part : in.correspondences) {
      for (std::int64_t i = 0; i < part.count(); ++i, ++row) {
        for (int k = 0; k < 2; ++k) all.template_px(row, k) = part.template_px(i, k);
        for (int k = 0; k < 2; ++k) all.image_px(row, k) = part.image_px(i, k);
        for (int k = 0; k < 3; ++k) all.barycentrics(row, k) = part.barycentrics(i, k);
        all.face(row) = part.face(i);
        all.kept(row) = part.kept(i);
      }
    }
    return all;
  }
};

/// Labelled matches without an image.
class MatchSource final : public weft::Source {
 public:
  static constexpr weft::About kAbout{.produces = "correspondences"};

  explicit MatchSource(weft::Params& p) { p.read("frames", frames_, "", {0, 1e6}, "how many"); }

  weft::Result<weft::Camera> open(const weft::Call&) override {
    return weft::Camera{kFocal_px, kFocal_px, 79.5, 59.5, 160, 120};
  }
  std::int64_t count() const override { return frames_; }
  weft::Result<weft::SourceFrame> read(std::int64_t, const weft::Call&) override {
    weft::SourceFrame frame;
    frame.correspondences = make_matches(4);
    std::fill_n(frame.correspondences->face.data(), 4, -1);
    return frame;
  }

 private:
  int frames_ = 1;
};

}  // namespace scripted
