// SPDX-License-Identifier: Apache-2.0
#include "common/warp_samples.hpp"

#include <string>

namespace weft::warps {

Result<WarpSamples> make_samples(const Points& points) {
  if (points.order < 0 || points.order > 2) {
    return Error{Errc::invalid_value,
                 "order " + std::to_string(points.order) + " of derivatives: request 0, 1 or 2"};
  }
  const std::int64_t count = points.xy_px.rows();
  WarpSamples samples;
  samples.xy_px = Array<double>({count, 2});
  samples.valid = Array<std::uint8_t>({count});
  if (points.order >= 1) samples.jacobian = Array<double>({count, 2, 2});
  if (points.order >= 2) samples.hessian = Array<double>({count, 2, 3});
  return samples;
}

void set_sample(WarpSamples& samples, std::int64_t i, const WarpAt& at) {
  Eigen::Map<Eigen::Vector2d>(samples.xy_px.row(i)) = at.value_px;
  samples.valid(i) = at.inside && at.value_px.allFinite() ? 1 : 0;
  if (samples.jacobian.present()) {
    Eigen::Map<Eigen::Matrix<double, 2, 2, Eigen::RowMajor>>(samples.jacobian.row(i)) = at.jacobian;
  }
  if (samples.hessian.present()) {
    Eigen::Map<Eigen::Matrix<double, 2, 3, Eigen::RowMajor>>(samples.hessian.row(i)) = at.hessian;
  }
}

}  // namespace weft::warps
