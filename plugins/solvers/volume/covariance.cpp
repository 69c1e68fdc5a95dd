// SPDX-License-Identifier: Apache-2.0
#include "covariance.hpp"

#include <algorithm>
#include <cmath>
#include <weft/core/index.hpp>

namespace weft::volume {
namespace {

constexpr double kPrior_m = 0.3;
// Neighbouring points of an outline have the same error.
constexpr double kOutlineNoise = 3.0;

/// Standard deviation of an observation, in units of what the energy takes it for.
double observed_noise(const Fit& fit) {
  return std::hypot(0.1, fit.residual * std::sqrt(fit.coherence));
}

/// Strain by which the body differs from the stiffest one that the observations allow.
double strain_of(const Fit& fit) { return std::hypot(0.01, fit.deformation); }

}  // namespace

Array<double> covariance_m2(const SolidModel& body, const Energy& energy, const FrameData& frame,
                            const Scales& scales, const Fit& fit, const Camera& camera,
                            const ScaleNoise& noise, const Points3& nodes_m,
                            solvers::DampedNewton& newton) {
  // All of H is in units of the observations' own noise.
  const double observed = observed_noise(fit);
  Scales wide = scales;
  wide.strain = strain_of(fit) / observed;
  wide.mean_strain = scales.mean_strain / observed;
  wide.unevenness = scales.unevenness / observed;
  wide.outline.noise_px *= kOutlineNoise;
  wide.known_m = std::max(scales.known_m, 5e-4) / observed;
  Points3 gradient(nodes_m.rows(), 3);
  energy.linearise(frame, wide, nodes_m, gradient, newton.matrix());
  const double prior = observed * observed / (kPrior_m * kPrior_m);
  if (!newton.factor().factorise(newton.matrix(), prior)) return {};
  std::vector<Eigen::Matrix3d> blocks(to_index(nodes_m.rows()));
  newton.factor().inverse_blocks(blocks);
  const auto assumed = CameraAssumption::of(camera);
  const double depth_sd = assumed ? assumed->focal_sd_px / camera.fx : 0.0;
  const Points3 surface_m = body.surface_of(nodes_m);
  const Eigen::RowVector3d middle_m = surface_m.colwise().mean();
  Array<double> covariance_m2({surface_m.rows(), 3, 3});
  for (Eigen::Index v = 0; v < surface_m.rows(); ++v) {
    const BodyPoint& at = body.vertices()[to_index(v)];
    Eigen::Matrix3d block = Eigen::Matrix3d::Zero();
    for (int a = 0; a < 4; ++a) {
      const std::int32_t node = body.tetrahedra()[to_index(at.tetrahedron)].node[to_index(a)];
      block += at.weights[a] * blocks[to_index(node)];
    }
    block *= observed * observed;
    // A template that is too large is that much further away, and reaches further from its middle.
    const Eigen::Vector3d along_m = middle_m.transpose();
    const Eigen::Vector3d around_m = (surface_m.row(v) - middle_m).transpose();
    block += noise.scale * noise.scale *
             (along_m * along_m.transpose() + around_m * around_m.transpose());
    block(2, 2) += std::pow(depth_sd * surface_m(v, 2), 2);
    std::copy_n(block.data(), 9, covariance_m2.row(v));
  }
  return covariance_m2;
}

}  // namespace weft::volume
