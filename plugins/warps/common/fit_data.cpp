// SPDX-License-Identifier: Apache-2.0
#include "common/fit_data.hpp"

#include <cmath>
#include <string>

namespace weft::warps {

Result<void> FitData::take(const FitInput& in, const TextureBox& box) {
  const Correspondences& matches = in.correspondences;
  if (in.weights && in.weights->weight.rows() != matches.count()) {
    return Error{Errc::invalid_data, "there must be one weight for each match"};
  }
  points_px_.clear();
  values_px_.clear();
  weights_.clear();
  dropped_ = 0;
  for (std::int64_t i = 0; i < matches.count(); ++i) {
    const double weight = in.weights ? in.weights->weight(i) : 1.0;
    if (!(weight >= 0.0) || std::isinf(weight)) {
      return Error{Errc::invalid_data,
                   "weight " + std::to_string(i) + " is not a finite number >= 0"};
    }
    if (matches.kept(i) == 0) continue;
    const double u = matches.template_px(i, 0), v = matches.template_px(i, 1);
    const double x = matches.image_px(i, 0), y = matches.image_px(i, 1);
    if (!std::isfinite(u) || !std::isfinite(v) || !std::isfinite(x) || !std::isfinite(y)) {
      return Error{Errc::invalid_data,
                   "match " + std::to_string(i) + " has a coordinate that is not finite"};
    }
    const bool inside = box.contains(u, v);
    if (!inside) ++dropped_;
    if (!inside || weight == 0.0) continue;
    points_px_.insert(points_px_.end(), {u, v});
    values_px_.insert(values_px_.end(), {x, y});
    weights_.push_back(weight);
  }
  if (!weights_.empty()) return {};
  return no_result("no match has a weight and is inside the domain of the warp");
}

}  // namespace weft::warps
