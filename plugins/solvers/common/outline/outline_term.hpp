// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>
#include <weft/geometry/camera_model.hpp>
#include <weft/geometry/types.hpp>

#include "mask_outline.hpp"
#include "rim.hpp"

namespace weft::solvers {

/// How the outline of a mask counts.
struct OutlineScales {
  double noise_px = 1.5;    ///< [] px, standard deviation of the outline across itself
  double outlier_px = 4.0;  ///< [] px, distance from which on a point has no influence
  double reach_px = 40.0;   ///< [] px, distance at which points are found at first
  double share = 1.0;       ///< [] of the weight; 0: the outline does not count
};

/// Contribution to the energy of an outline point r standard deviations off (Tukey): r^2 where r is
/// small, and c^2 / 3 from r = c on.
struct TukeyLoss {
  double limit = 1.0;  ///< [] c, standard deviations

  double most() const { return limit * limit / 3.0; }
  /// Adds to the energy; returns the weight of the point in least squares.
  double weight(double r, double& energy) const {
    const double left = std::max(1.0 - r * r / (limit * limit), 0.0);
    energy += most() * (1.0 - left * left * left);
    return left * left;
  }
};

/// A point of a face that is pulled to a line of the image.
struct OutlinePoint {
  std::int32_t face = 0;
  std::array<double, 3> weights{};  ///< [3] in the face, sum 1
  Eigen::Vector2d normal;           ///< unit normal of the line
  double offset_px = 0.0;           ///< [] px, normal . y for the points y of the line
  double share = 1.0;               ///< [] of its weight
};

/// The part of a mesh's energy that makes the rim of the shape meet the outline of the mask,
///   s sum_b w_b rho(n_b . (pi(p_b(X)) - y_b) / noise_px),
/// over rim points b with the nearest outline along their normals (w = 1), and over outline points
/// with the nearest rim point (w = 1/2). The second kind pulls a rim outwards that lies within the
/// mask. Both are distances across a line: the rim may slide along itself. A known point of either
/// kind that meets nothing adds most(), so that shapes can be compared.
class OutlineTerm {
 public:
  void prepare(const Faces& faces, Eigen::Index vertex_count) { rim_.prepare(faces, vertex_count); }

  /// Finds which points meet, for the shape [V,3]. `on_surface(face, weights)` is where the surface
  /// is over a point of a face, in m.
  template <class OnSurface>
  void meet(const MaskOutline& outline, const Pinhole& camera, const OutlineScales& scales,
            const Points3& vertices_m, const std::vector<std::uint8_t>& covered,
            const OnSurface& on_surface) {
    forget();
    if (!outline.present() || !(scales.share > 0.0)) return;
    rim_px_.clear();
    const auto& rim =
        rim_.find(camera, outline.width_px(), outline.height_px(), vertices_m, covered);
    for (const RimPoint& point : rim) {
      rim_px_.push_back(project(camera, on_surface(point.face, point.weights)));
    }
    meet_rim(outline, scales, rim);
  }
  void forget();

  const std::vector<OutlinePoint>& points() const { return points_; }
  const TukeyLoss& loss() const { return loss_; }
  /// Multiplies all weights.
  double share = 1.0;
  /// Energy of the points that meet nothing.
  double missed() const { return missed_ * loss_.most(); }
  /// [] of the known rim points, those that meet the outline.
  double met_share() const;

 private:
  void meet_rim(const MaskOutline& outline, const OutlineScales& scales,
                const std::vector<RimPoint>& rim);
  void meet_contour(const MaskOutline& outline, double reach_px, const std::vector<RimPoint>& rim);

  RimFinder rim_;
  std::vector<Eigen::Vector2d> rim_px_;  ///< places of the rim points, on the surface
  std::vector<OutlinePoint> points_;
  TukeyLoss loss_;
  double missed_ = 0.0;  ///< sum of the weights of points that meet nothing
  std::size_t rim_met_ = 0, rim_missed_ = 0;
};

}  // namespace weft::solvers
