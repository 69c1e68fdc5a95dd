// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>
#include <weft/geometry/types.hpp>

#include "common/image_motion.hpp"
#include "energy.hpp"
#include "mesh/mesh_model.hpp"

namespace weft::gauss_newton {

/// How well a shape explains the observations and keeps the lengths.
struct Fit {
  double residual_px = 0.0;  ///< [] px, median distance of observations to where the shape has them
  double residual = 0.0;     ///< [] the same in units of their noise
  double far_share = 0.0;    ///< [] of the observations, those more than 3 px off
  double far_around = 0.0;   ///< [] the most of it among four or more around one vertex
  double strain = 0.0;       ///< [] mean |l / l0 - 1| over the edges
  double crease = 0.0;       ///< [] 95th percentile of it
  /// [] of residuals, at least 1. Ratio of the variance of their means around vertices to the
  /// variance that independent residuals would have. Correlated residuals count as one.
  double coherence = 1.0;
  double back_share = 0.0;  ///< [] of the faces with observations, those that show their back
};

/// Measures shapes; keeps its memory.
class FitGauge {
 public:
  /// `energy` follows the shape. Points that are not in front of the camera are infinitely far off.
  Fit measure(const MeshModel& mesh, const FrameData& frame, const Energy& energy,
              const Points3& vertices_m);

  /// The same where nothing but the outline is seen, as it was met last.
  Fit measure_outline(const MeshModel& mesh, const FrameData& frame, double noise_px,
                      const Energy& energy, const Points3& vertices_m);

  /// How far a shape is from where the observations are, its faces taken for flat.
  solvers::ImageMotion motion(const MeshModel& mesh, const FrameData& frame,
                              const Points3& vertices_m);

  /// True if the median of the observed points is behind the camera.
  bool is_behind(const MeshModel& mesh, const FrameData& frame, const Points3& vertices_m);

 private:
  void measure_lengths(const MeshModel& mesh, const Points3& vertices_m, Fit& fit);
  double far_around(const MeshModel& mesh, const FrameData& frame);
  double coherence(const MeshModel& mesh, const FrameData& frame);

  struct Sum {
    Eigen::Vector2d whitened = Eigen::Vector2d::Zero();
    int count = 0;
  };

  std::vector<double> first_, second_;
  std::vector<Eigen::Vector2d> whitened_;        ///< residuals of the observations, in units of
                                                 ///< their noise
  std::vector<Sum> sums_;                        ///< [V] of those in faces of it
  std::vector<std::array<int, 2>> seen_around_;  ///< [V] observations in faces of it, those far off
  Points2 measured_px_, projected_px_;
};

}  // namespace weft::gauss_newton
