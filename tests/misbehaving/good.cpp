// SPDX-License-Identifier: Apache-2.0
// Well-behaved components with a parameter of every kind: each records in its evidence what it was
// given. They share a folder with the broken ones.
#include <weft/sdk/filter.hpp>
#include <weft/sdk/warp_model.hpp>

namespace {

enum class Colour { red, green, blue };

/// Keeps every match.
class Good final : public weft::Filter {
 public:
  static constexpr weft::About kAbout{
      .reference = "own: nothing published", .reads = "template", .random = true};

  explicit Good(weft::Params& p) {
    p.read("length_mm", length_mm_, "mm", {0, 100}, "a length");
    p.read("free", free_, "", {}, "any number");
    p.read("count", count_, "", {-5, 1000}, "a whole number");
    p.read("flag", flag_, "a flag");
    p.choice("colour", colour_,
             {{"red", Colour::red}, {"green", Colour::green}, {"blue", Colour::blue}},
             "one of three words");
    p.read("limits_px", limits_px_, "px", {-10, 10}, "a vector of numbers");
    p.text("title", title_, "a text");
    p.input_path("table", table_, "a file that is read");
    p.output_path("report", report_, "a file that is written");
    p.labels("apart", labels_, "texts by name");
    p.component("warp", warp_, "a component of its own");
    p.read("steps", steps_, "frames", {-9, 1e15}, "a vector of whole numbers");
    p.read("words", words_, "a list of texts");
  }

  weft::Result<weft::InlierMask> filter(const weft::FilterInput& in) override {
    const std::int64_t n = in.correspondences.count();
    weft::InlierMask mask{weft::Array<std::uint8_t>({n}, 0), weft::Array<double>({n}, 0.0), {}};
    for (std::int64_t i = 0; i < n; ++i) {
      mask.kept(i) = 1;
      mask.score(i) = 1.0;
    }
    weft::Diagnostics& diag = mask.diag;
    diag.set("length_mm", length_mm_);
    diag.set("free", free_);
    diag.set("count", static_cast<double>(count_));
    diag.set("flag", flag_ ? 1.0 : 0.0);
    diag.set("colour", static_cast<double>(colour_));
    diag.set("limits", static_cast<double>(limits_px_.size()));
    diag.set("title_length", static_cast<double>(title_.size()));
    diag.set("table_length", static_cast<double>(table_.size()));
    diag.set("report_length", static_cast<double>(report_.size()));
    diag.set("labels", static_cast<double>(labels_.size()));
    weft::Array<std::int64_t> steps({static_cast<std::int64_t>(steps_.size())});
    std::copy(steps_.begin(), steps_.end(), steps.data());
    diag.set("steps", steps);
    for (const std::string& word : words_) {
      diag.set("length_of_" + word, static_cast<double>(word.size()));
    }
    diag.set("first_draw", in.call.rng().uniform());
    if (!in.templ) return mask;
    const auto warp = warp_.fit(in.call, in.correspondences, *in.templ);
    if (!warp) return warp.error();
    const auto samples = weft::evaluate(in.call, *warp, {in.correspondences.template_px, 0});
    if (!samples) return samples.error();
    diag.set("shifted_u", n > 0 ? samples->xy_px(0, 0) : 0.0);
    // The nested warp records its input.
    if (const auto* revision = warp->diag.find<std::int64_t>("template_revision")) {
      diag.set("template_revision", *revision);
    }
    if (const auto* weight = warp->others.find<std::uint16_t>("x.acme.weight")) {
      mask.others.set("x.acme.weight", *weight);
    }
    return mask;
  }

 private:
  double length_mm_ = 12.5;
  double free_ = -1e6;
  int count_ = 3;
  bool flag_ = true;
  Colour colour_ = Colour::green;
  std::vector<double> limits_px_{-1.0, 2.5};
  std::vector<std::int64_t> steps_{3, -4};
  std::vector<std::string> words_{"one", "three"};
  std::string title_ = "untitled";
  std::string table_;
  std::string report_;
  std::vector<std::pair<std::string, std::string>> labels_;
  weft::WarpComponent warp_{"warps/test_shift"};
};

/// Cannot be used without its parameters.
class Strict final : public weft::Filter {
 public:
  explicit Strict(weft::Params& p) {
    p.read("ratio", ratio_, "", {0, 1}, "a share", weft::Need::required);
    p.read("rounds", rounds_, "", {1, 9}, "how often", weft::Need::required);
    p.input_path("model", model_, "a file that must be given", weft::Need::required);
  }

  weft::Result<weft::InlierMask> filter(const weft::FilterInput& in) override {
    const std::int64_t n = in.correspondences.count();
    weft::InlierMask mask{weft::Array<std::uint8_t>({n}, 0), weft::Array<double>({n}, 0.0), {}};
    mask.diag.set("ratio", ratio_);
    mask.diag.set("rounds", rounds_);
    return weft::degenerate(std::move(mask), "keeps nothing");
  }

 private:
  double ratio_ = 0.0;
  int rounds_ = 0;
  std::string model_;
};

/// x = u + shift, y = v. Fails on demand in any of its methods.
class Shift final : public weft::WarpModel {
 public:
  explicit Shift(weft::Params& p) {
    p.read("shift_px", shift_px_, "px", {-1000, 1000}, "along u");
    p.read("extra_samples", extra_samples_, "", {-10, 10}, "more samples than points: a mistake");
    p.read("always_fails", always_fails_, "never fits");
    p.output_path("notes", notes_, "a file that is not written");
  }

  weft::Result<weft::Warp> fit(const weft::FitInput& in) override {
    if (always_fails_) return weft::no_result("told to fail");
    weft::Warp warp;
    warp.producer = "warps/test_shift";
    warp.domain_px = weft::Array<double>({4}, 0.0);
    weft::Array<double> shift({1}, 0.0);
    shift(0) = shift_px_;
    warp.model.entries.push_back({"model.shift_px", shift});
    warp.diag.set("template_revision",
                  weft::Array<std::int64_t>({}, static_cast<std::int64_t>(in.templ.revision)));
    if (const auto* weight = in.correspondences.others.find<std::uint16_t>("x.acme.weight")) {
      warp.others.set("x.acme.weight", *weight);
    }
    return warp;
  }

  weft::Result<weft::WarpSamples> evaluate(const weft::EvaluateInput& in) override {
    const weft::Array<double>* shift = in.warp.model.find("model.shift_px");
    if (shift == nullptr) return weft::Error{weft::Errc::invalid_data, "not my warp"};
    const std::int64_t count = std::max<std::int64_t>(in.points.xy_px.rows() + extra_samples_, 0);
    weft::WarpSamples samples;
    samples.xy_px = weft::Array<double>({count, 2}, 0.0);
    samples.valid = weft::Array<std::uint8_t>({count}, 0);
    for (std::int64_t i = 0; i < std::min(count, in.points.xy_px.rows()); ++i) {
      samples.xy_px(i, 0) = in.points.xy_px(i, 0) + (*shift)(0);
      samples.xy_px(i, 1) = in.points.xy_px(i, 1);
      samples.valid(i) = 1;
    }
    return samples;
  }

 private:
  double shift_px_ = 2.0;
  int extra_samples_ = 0;
  bool always_fails_ = false;
  std::string notes_;
};

}  // namespace

WEFT_LIBRARY(WEFT_COMPONENT(Good, "filters/test_good", "1.2.3",
                            "Keeps every match; \"quoted\", \\ and all."),
             WEFT_COMPONENT(Strict, "filters/test_strict", "1.0.0", "Needs its parameters."),
             WEFT_COMPONENT(Shift, "warps/test_shift", "1.0.0", "Shifts the texture."))
