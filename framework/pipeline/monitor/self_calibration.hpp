// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>
#include <weft/data/camera.hpp>
#include <weft/data/correspondences.hpp>
#include <weft/data/template.hpp>
#include <weft/geometry/distance_constraints.hpp>
#include <weft/geometry/mesh_bending.hpp>

#include "pipeline/monitor/camera_evidence.hpp"

namespace weft {

/// Calibrates the camera from a surface whose lengths are known (bundle adjustment of a single
/// frame): minimises, over vertices and camera at once,
///
///     sum_matches rho(|projection - pixel| / noise) + sum_edges ((|d| - l0) / (strain l0))^2
///       + sum_hinges (bend - bend at rest)^2 / (0.3 rad)^2
///
/// by Gauss-Newton from the shape of a solver. Noise and strain are those of the matches and edges
/// (0.5 px and 0.002 at least). The vertices are eliminated from the normal equations (Schur
/// complement). A flat surface seen frontally contains no information on the focal length, and a
/// stretching cloth next to none; the information matrix then shows it.
class SelfCalibration {
 public:
  /// Error where the template's mesh is no surface.
  static Result<SelfCalibration> of(const Template& templ);

  /// `vertices_m` [V,3] m, camera frame. Nothing where fewer than 30 kept matches lie on the mesh,
  /// or where no such camera explains them.
  std::optional<CameraEvidence> look(const Camera& camera, const Points3View& vertices_m,
                                     const Correspondences& matches);

 private:
  struct Observation {
    std::int32_t face;         ///< [] index of a face
    Eigen::Vector3d weights;   ///< barycentric
    Eigen::Vector2d pixel_px;  ///< where it is seen
  };
  struct State {
    Points3 vertices_m;
    PartVector deviation;
    double noise_px, strain;  ///< [] px; [] relative length error
  };

  bool measure_noise(const Camera& camera, State& state);
  double measured_strain(const State& state);
  void add_matches(const Camera& camera, const State& state);
  void add_edges(const State& state);
  void add_hinges(const State& state);
  Eigen::Vector3d bend_off(const State& state, std::size_t hinge) const;
  double edge_over_m(const State& state, std::size_t e) const;
  /// The minimised cost, with noise and strain as they are; infinite behind the camera.
  double cost(const Camera& camera, const State& state) const;
  /// Largest change of a part, in standard deviations, 0 where nothing is better; nothing where the
  /// equations cannot be solved.
  std::optional<double> step(const Camera& camera, CameraEvidence& evidence);

  Faces faces_;
  std::vector<DistanceConstraint> edges_;
  Points3 edge_places_;      ///< [E,3] x, y, x^2 + y^2 of the middle of each edge
  Points2 edge_directions_;  ///< [E,2] cosine and sine of twice its angle to the width
  std::vector<BendingHinge> hinges_;
  std::vector<double> rest_bend_rad_;  ///< angle of each hinge
  std::vector<Observation> observations_;
  std::vector<Eigen::Matrix<double, 9, 9>> face_blocks_;
  // From look to look, so that only the first of them allocates.
  NormalEquations equations_;
  State state_, next_;
  PartVector step_at_;  ///< the deviation at which the last step was made
  Eigen::VectorXd move_;
  std::vector<double> residuals_px_, strains_;
};

}  // namespace weft
