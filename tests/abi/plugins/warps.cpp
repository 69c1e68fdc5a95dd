// SPDX-License-Identifier: Apache-2.0
#include <weft/sdk/warp_model.hpp>

namespace {

/// A shift by what the first and the last match move in the middle.
struct Small final : weft::WarpModel {
  explicit Small(weft::Params&) {}

  weft::Result<weft::Warp> fit(const weft::FitInput& in) override {
    const auto& at = in.correspondences;
    const std::int64_t last = at.count() - 1;
    if (last < 0) return weft::no_result("no matches");
    weft::Warp warp;
    warp.producer = "warps/kept.small";
    warp.domain_px = weft::Array<double>({4}, 0.0);
    warp.domain_px(1) = 8.0;
    warp.domain_px(3) = 6.0;
    weft::Array<double> shift_px({2});
    for (std::int64_t axis = 0; axis < 2; ++axis) {
      shift_px(axis) = 0.5 * (at.image_px(0, axis) - at.template_px(0, axis) +
                              at.image_px(last, axis) - at.template_px(last, axis));
    }
    warp.model.entries.push_back({"model.shift_px", shift_px});
    const auto* mark = at.others.find<std::int16_t>("x.kept.mark");
    if (mark != nullptr) warp.model.entries.push_back({"model.mark", *mark});
    if (last == 0) return weft::degenerate(warp, "one match");
    return warp;
  }

  weft::Result<weft::WarpSamples> evaluate(const weft::EvaluateInput& in) override {
    const auto* shift_px = in.warp.model.find("model.shift_px");
    if (shift_px == nullptr) return weft::Error{weft::Errc::invalid_data, "no model", {}};
    const std::int64_t m = in.points.xy_px.rows();
    weft::WarpSamples samples;
    samples.xy_px = weft::Array<double>({m, 2});
    samples.valid = weft::Array<std::uint8_t>({m}, 1);
    for (std::int64_t i = 0; i < m; ++i) {
      for (std::int64_t axis = 0; axis < 2; ++axis) {
        samples.xy_px(i, axis) = in.points.xy_px(i, axis) + (*shift_px)(axis);
      }
    }
    if (in.points.order >= 1) {
      samples.jacobian = weft::Array<double>({m, 2, 2}, 0.0);
      for (std::int64_t i = 0; i < m; ++i) samples.jacobian(i, 0) = samples.jacobian(i, 3) = 1.0;
    }
    if (in.points.order >= 2) samples.hessian = weft::Array<double>({m, 2, 3}, 0.0);
    return samples;
  }
};

}  // namespace

WEFT_PLUGIN(Small, "warps/kept.small", "1.0.0", "A shift.")
