// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <weft/sdk/matcher.hpp>

namespace {

/// Pairs keypoints in their order.
struct Small final : weft::Matcher {
  static constexpr weft::About kAbout{.needs = "keypoints template_keypoints"};

  explicit Small(weft::Params&) {}

  weft::Result<weft::Correspondences> match(const weft::MatcherInput& in) override {
    if (!in.template_keypoints) return weft::no_result("no keypoints of the template");
    const std::int64_t n = std::min(in.keypoints->count(), in.template_keypoints->count());
    if (n == 0) return weft::no_result("no keypoints");
    weft::Correspondences pairs;
    pairs.template_px = weft::Array<double>({n, 2});
    pairs.image_px = weft::Array<double>({n, 2});
    pairs.template_keypoint = weft::Array<std::int32_t>({n});
    pairs.image_keypoint = weft::Array<std::int32_t>({n});
    pairs.face = weft::Array<std::int32_t>({n}, -1);
    pairs.barycentrics = weft::Array<double>({n, 3}, 0.0);
    pairs.kept = weft::Array<std::uint8_t>({n}, 1);
    pairs.score = weft::Array<double>({n}, 1.0);
    for (std::int64_t i = 0; i < n; ++i) {
      pairs.template_keypoint(i) = pairs.image_keypoint(i) = static_cast<std::int32_t>(i);
      for (std::int64_t axis = 0; axis < 2; ++axis) {
        pairs.template_px(i, axis) = in.template_keypoints->xy_px(i, axis);
        pairs.image_px(i, axis) = in.keypoints->xy_px(i, axis);
      }
    }
    pairs.others.set("x.kept.mark", weft::Array<std::int16_t>({2}, -7));
    return pairs;
  }
};

}  // namespace

WEFT_PLUGIN(Small, "matchers/kept.small", "1.0.0", "Pairs keypoints in their order.")
