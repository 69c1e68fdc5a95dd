// SPDX-License-Identifier: Apache-2.0
#include "exact_mask.hpp"

#include <algorithm>
#include <cmath>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>

namespace weft::frex {
namespace {

constexpr std::int32_t kSheet = 0;
constexpr std::int64_t kMargin_px = 2;  // the lens blurs the occluder's outline

}  // namespace

ObjectMask exact_mask(const scene::View& view) {
  const std::int64_t height = view.image.height, width = view.image.width;
  ObjectMask mask;
  mask.foreground = Array<std::uint8_t>({height, width}, 0);
  mask.known = Array<std::uint8_t>({height, width}, 1);
  for (std::int64_t y = 0; y < height; ++y) {
    ask_to_go_on();
    for (std::int64_t x = 0; x < width; ++x) {
      mask.foreground(y, x) = static_cast<std::uint8_t>(std::lround(255.0F * view.coverage(y, x)));
      if (view.hits[to_index(y * width + x)].mesh <= kSheet) continue;
      const std::int64_t left = std::max(x - kMargin_px, std::int64_t{0});
      const std::int64_t right = std::min(x + kMargin_px + 1, width);
      const std::int64_t below = std::min(y + kMargin_px + 1, height);
      for (std::int64_t j = std::max(y - kMargin_px, std::int64_t{0}); j < below; ++j) {
        std::fill(mask.known.row(j) + left, mask.known.row(j) + right, std::uint8_t{0});
      }
    }
  }
  return mask;
}

}  // namespace weft::frex
