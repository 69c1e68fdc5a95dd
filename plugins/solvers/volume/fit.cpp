// SPDX-License-Identifier: Apache-2.0
#include "fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/statistics.hpp>

namespace weft::volume {
namespace {

/// For n independent residuals of variance s^2 the square of the sum is n s^2 on average.
double coherence(const SolidModel& body, const FrameData& frame,
                 const std::vector<Eigen::Vector2d>& whitened) {
  constexpr double kOutlier = 3.0;
  constexpr int kFewestAround = 4;
  struct Sum {
    Eigen::Vector2d whitened = Eigen::Vector2d::Zero();
    int count = 0;
  };
  std::vector<Sum> sums(to_index(body.nodes_m().rows()));
  double squares = 0.0, squares_of_sums = 0.0;
  int counted = 0, counted_around = 0;
  for (std::size_t i = 0; i < whitened.size(); ++i) {
    if (!(whitened[i].norm() <= kOutlier)) continue;
    squares += whitened[i].squaredNorm();
    ++counted;
    const auto& in = body.tetrahedra()[to_index(frame.observations[i].point.tetrahedron)];
    for (const std::int32_t node : in.node) {
      sums[to_index(node)].whitened += whitened[i];
      ++sums[to_index(node)].count;
    }
  }
  for (const Sum& sum : sums) {
    if (sum.count < kFewestAround) continue;
    squares_of_sums += sum.whitened.squaredNorm() / sum.count;
    ++counted_around;
  }
  if (!(squares > 0.0) || counted_around == 0) return 1.0;
  return std::max(1.0, squares_of_sums / counted_around / (squares / counted));
}

}  // namespace

Fit measure(const SolidModel& body, const Energy& energy, const FrameData& frame,
            const Scales& scales, const Points3& nodes_m) {
  constexpr double kFar_px = 3.0;
  const double infinity = std::numeric_limits<double>::infinity();
  std::vector<double> distances_px, distances;
  std::vector<Eigen::Vector2d> whitened;
  double far = 0.0;
  for (const Observation& o : frame.observations) {
    const Eigen::Vector3d point_m = o.point.on(body.tetrahedra(), nodes_m);
    const bool in_front = point_m.z() > 0.0;
    const Eigen::Vector2d off_px = in_front
                                       ? Eigen::Vector2d(project(frame.camera, point_m) - o.seen_px)
                                       : Eigen::Vector2d::Constant(infinity);
    whitened.emplace_back(o.white.xx * off_px.x(),
                          o.white.yx * off_px.x() + o.white.yy * off_px.y());
    distances_px.push_back(in_front ? off_px.norm() : infinity);
    distances.push_back(in_front ? whitened.back().norm() : infinity);
    if (!(distances_px.back() <= kFar_px)) far += 1.0;
  }
  Fit fit;
  fit.far_share = far / static_cast<double>(std::max<std::size_t>(1, distances.size()));
  fit.residual_px = median_in_place(distances_px);
  fit.residual = median_in_place(distances);
  fit.deformation = std::sqrt(energy.mean_deformation(scales.material, nodes_m));
  fit.coherence = coherence(body, frame, whitened);
  return fit;
}

}  // namespace weft::volume
