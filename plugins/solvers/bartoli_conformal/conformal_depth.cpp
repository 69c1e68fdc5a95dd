// SPDX-License-Identifier: Apache-2.0
#include "conformal_depth.hpp"

#include <algorithm>
#include <cmath>
#include <vector>
#include <weft/core/index.hpp>

#include "common/patches.hpp"
#include "common/smooth_spline.hpp"
#include "signs.hpp"

namespace weft::bartoli_conformal {
namespace {

/// log s at each place for one of the two signs, its median 0 in each patch, [n].
Eigen::VectorXd log_scales(const std::vector<int>& patches, const Eigen::VectorXd& psi,
                           const Eigen::VectorXd& log_isometric) {
  const Eigen::VectorXd scales = psi - log_isometric;
  return scales - solvers::medians_of_patches(patches, scales);
}

}  // namespace

Result<ConformalSurface> conformal_surface(solvers::SplineEquations& equations,
                                           const solvers::IsometricReading& reading,
                                           double smoothing) {
  const Eigen::Index count = reading.points_m.rows();
  Points2 gradients(count, 2);
  Eigen::VectorXd log_isometric(count);
  for (Eigen::Index g = 0; g < count; ++g) {
    const solvers::IsometricPoint& point = reading.points[to_index(g)];
    gradients.row(g) = point.gradient_mpp.transpose() / point.distance_m;
    log_isometric(g) = std::log(point.distance_m);
  }
  const std::vector<double> signs = continuous_signs(reading.places, gradients);
  for (Eigen::Index g = 0; g < count; ++g) gradients.row(g) *= signs[to_index(g)];
  const std::vector<bool> all(signs.size(), true);
  const auto psi =
      solvers::integrate_gradients(equations, reading.places_px, gradients, all, smoothing);
  if (!psi) return psi.error();

  const std::vector<int> patches = solvers::patches_of(reading.places);
  const Eigen::VectorXd one = log_scales(patches, *psi, log_isometric);
  const Eigen::VectorXd other = log_scales(patches, -*psi, log_isometric);
  // Each patch has its own sign.
  const Eigen::VectorXd one_spread = solvers::means_of_patches(patches, one.cwiseAbs2());
  const Eigen::VectorXd other_spread = solvers::means_of_patches(patches, other.cwiseAbs2());
  ConformalSurface found;
  found.points_m.resize(count, 3);
  for (Eigen::Index g = 0; g < count; ++g) {
    const bool is_one = one_spread(g) <= other_spread(g);
    const double scale = std::exp(is_one ? one(g) : other(g));
    found.points_m.row(g) = scale * reading.points_m.row(g);
    found.scale_spread += std::min(one_spread(g), other_spread(g));
    found.other_scale_spread += std::max(one_spread(g), other_spread(g));
  }
  found.scale_spread = std::sqrt(found.scale_spread / static_cast<double>(count));
  found.other_scale_spread = std::sqrt(found.other_scale_spread / static_cast<double>(count));
  return found;
}

}  // namespace weft::bartoli_conformal
