// SPDX-License-Identifier: Apache-2.0
#include <weft/sdk/filter.hpp>
#include <weft/sdk/nested.hpp>

namespace {

/// Keeps matches that move less than a limit, relative to a fitted warp, and samples scores.
struct Small final : weft::Filter {
  static constexpr weft::About kAbout{.needs = "template", .reads = "camera", .random = true};
  double limit_px = 2.0;
  std::vector<double> steps = {1.0, 2.0};
  weft::WarpComponent warp{"warps/kept.small"};

  explicit Small(weft::Params& p) {
    p.read("limit_px", limit_px, "px", {0, 100}, "a match that moves more is rejected");
    p.read("steps", steps, "px", {0, 100}, "added to the limit");
    p.component("warp", warp, "the warp that is fitted");
  }

  weft::Result<weft::InlierMask> filter(const weft::FilterInput& in) override {
    const auto fitted = warp.fit(in.call, in.correspondences, *in.templ);
    if (!fitted) return fitted.error();
    const auto shift = fitted->model.find("model.shift_px");
    weft::Rng rng = in.call.rng();
    const std::int64_t n = in.correspondences.count();
    weft::InlierMask mask{weft::Array<std::uint8_t>({n}), weft::Array<double>({n}), {}};
    for (std::int64_t i = 0; i < n; ++i) {
      const double dx = in.correspondences.image_px(i, 0) - in.correspondences.template_px(i, 0);
      const double off = dx - *shift->data();
      mask.kept(i) = off <= limit_px + steps[0] && -off <= limit_px + steps[0] ? 1 : 0;
      mask.score(i) = 0.5 * rng.uniform(0.0, 1.0) + (in.camera ? 0.25 : 0.0);
    }
    mask.confidence = weft::make_scalar(0.75);
    mask.diag.set("shift_px", *shift->data());
    const auto* mark = fitted->model.find<std::int16_t>("model.mark");
    if (mark != nullptr) mask.others.set("x.kept.mark", *mark);
    return mask;
  }
};

}  // namespace

WEFT_PLUGIN(Small, "filters/kept.small", "1.0.0", "Keeps what moves as the warp does.")
