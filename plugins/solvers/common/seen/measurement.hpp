// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

namespace weft::solvers {

/// W of a covariance (W^T W)^-1: where e has that covariance, W e has the standard deviation 1 in
/// each direction.
struct Whitening {
  double xx = 0.0, yx = 0.0, yy = 0.0;  ///< 1/px, of the lower triangle

  /// With the same standard deviation along u and v.
  static Whitening of_deviation(double deviation_px) {
    return {1.0 / deviation_px, 0.0, 1.0 / deviation_px};
  }
  /// From a covariance [[uu, uv], [uv, vv]], px^2; nothing where that is not positive definite.
  static std::optional<Whitening> of_covariance(double uu, double uv, double vv) {
    const double u = std::sqrt(uu), along = uv / u, v = std::sqrt(vv - along * along);
    const Whitening white{1.0 / u, -along / (u * v), 1.0 / v};
    const double least = std::min(white.xx, white.yy);
    if (!(least > 0.0) || !std::isfinite(white.xx + white.yx + white.yy)) return std::nullopt;
    return white;
  }
  /// From a covariance [2,2] px^2, row by row, plus noise along u and v; nothing where that is not
  /// positive definite.
  static std::optional<Whitening> of_measured(const double* covariance_px2, double noise2_px2) {
    const double uv = 0.5 * (covariance_px2[1] + covariance_px2[2]);
    if (!(covariance_px2[0] >= 0.0 && covariance_px2[3] >= 0.0)) return std::nullopt;
    return of_covariance(covariance_px2[0] + noise2_px2, uv, covariance_px2[3] + noise2_px2);
  }
};

/// The energy of an observation with a residual of r standard deviations: r^2 where r is small.
/// Beyond `scale` it is about 2 scale r (Huber), or at most scale^2 (Geman and McClure). The latter
/// ignores outliers but needs a good initial shape.
struct Trust {
  double scale = 1.0;       ///< [] standard deviations
  bool redescends = false;  ///< [] Geman and McClure's, else Huber's

  /// Adds to the energy; returns the weight of the observation in least squares.
  double weight(double r2, double& energy) const {
    const double scale2 = scale * scale;
    if (redescends) {
      const double share = scale2 / (scale2 + r2);
      energy += r2 * share;
      return share * share;
    }
    if (r2 <= scale2) {
      energy += r2;
      return 1.0;
    }
    const double r = std::sqrt(r2);
    energy += scale * (2.0 * r - scale);
    return scale / r;
  }
};

}  // namespace weft::solvers
