// SPDX-License-Identifier: Apache-2.0
#include "common/view/coarse_search.hpp"

#include <algorithm>
#include <cmath>
#include <weft/core/stop_check.hpp>

namespace weft::view {
namespace {

constexpr float kPricePerPx = 0.01F;  // [1/px] correlation that a pixel farther must gain

}  // namespace

void CoarseSearch::lay_out(const ViewLevel& view, int reach_px, const Picture& image) {
  reach_ = reach_px;
  rows_ = view.grey.height;
  columns_ = (view.grey.width + kLanes - 1) / kLanes * kLanes;
  weight_.assign(to_index(rows_ * columns_), 0.0F);
  grey_.assign(weight_.size(), 0.0F);
  drawn_ = 0.0F;
  for (int y = 0; y < rows_; ++y) {
    for (int x = 0; x < view.grey.width; ++x) {
      if (view.drawn_row(y)[x] == 0) continue;
      weight_[to_index(y * columns_ + x)] = 1.0F;
      grey_[to_index(y * columns_ + x)] = view.grey.row(y)[x];
      drawn_ += 1.0F;
    }
  }
  stride_ = columns_ + 2 * reach_;
  image_.assign(to_index(stride_ * (rows_ + 2 * reach_)), 0.0F);
  image_weight_.assign(image_.size(), 0.0F);
  for (int y = 0; y < rows_ + 2 * reach_; ++y) {
    const int image_y = y + view.y0 - reach_;
    if (image_y < 0 || image_y >= image.height) continue;
    const int left = view.x0 - reach_;
    const int from = std::max(-left, 0), to = std::min(stride_, image.width - left);
    if (from >= to) continue;
    const auto at = static_cast<std::ptrdiff_t>(y) * stride_;
    std::copy(image.row(image_y) + left + from, image.row(image_y) + left + to,
              image_.begin() + at + from);
    std::fill(image_weight_.begin() + at + from, image_weight_.begin() + at + to, 1.0F);
  }
}

float CoarseSearch::correlation_at(int dx, int dy) const {
  Lanes n{}, t{}, tt{}, i{}, ii{}, it{};
  for (int y = 0; y < rows_; ++y) {
    const std::size_t at = to_index(y * columns_);
    const std::size_t image_at = to_index((y + dy + reach_) * stride_ + dx + reach_);
    for (int x = 0; x < columns_; x += kLanes) {
      const std::size_t k = at + to_index(x), m = image_at + to_index(x);
      const Lanes weight = load_lanes(weight_.data() + k) * load_lanes(image_weight_.data() + m);
      const Lanes grey = weight * load_lanes(grey_.data() + k);
      const Lanes seen = weight * load_lanes(image_.data() + m);
      n += weight;
      t += grey;
      tt += grey * grey;
      i += seen;
      ii += seen * seen;
      it += seen * grey;
    }
  }
  const float count = sum_of(n);
  if (count < 0.5F * drawn_ || count < 16.0F) return 0.0F;
  const float spread_t = sum_of(tt) - sum_of(t) * sum_of(t) / count;
  const float spread_i = sum_of(ii) - sum_of(i) * sum_of(i) / count;
  if (!(spread_t > count && spread_i > count)) return 0.0F;  // one grey level
  return (sum_of(it) - sum_of(i) * sum_of(t) / count) / std::sqrt(spread_t * spread_i);
}

CoarseShift CoarseSearch::find(const PredictedView& view, const Pyramid& image, double search_px) {
  const int reach_px = static_cast<int>(std::ceil(search_px / (1 << kSheetLevel)));
  lay_out(view.level(kSheetLevel), reach_px, image.level(kSheetLevel));
  CoarseShift best{0, 0, correlation_at(0, 0)};
  float best_score = best.correlation;
  for (int dy = -reach_; dy <= reach_; ++dy) {
    worked(static_cast<std::int64_t>(2 * reach_ + 1) * rows_ * columns_ / 16);
    for (int dx = -reach_; dx <= reach_; ++dx) {
      const float correlation = correlation_at(dx, dy);
      const float score =
          correlation - kPricePerPx * std::hypot(static_cast<float>(dx), static_cast<float>(dy));
      if (score <= best_score) continue;
      best_score = score;
      best = {dx, dy, correlation};
    }
  }
  return best;
}

}  // namespace weft::view
