// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "common/laplacian/control_mesh.hpp"
#include "common/laplacian/inlier_search.hpp"

namespace weft::solvers {

/// The constraint on the edges.
enum class Lengths { at_most, equal };

/// The defaults are the constants of the authors' program (Ngo, Ostlund, Fua, deformabletracker).
/// Its weights are in pixels and millimetres; here they are divided by its focal length, 624 px.
struct LengthFitOptions {
  Lengths lengths = Lengths::at_most;
  double stiffness = 0.84;      ///< []
  double tension_m = 5.1e-3;    ///< [] m, at_most: how hard each edge pulls for its length
  double length_weight = 10.0;  ///< [] equal, ours: the number of matches that one edge counts as
  double previous = 0.0;        ///< [] weight of the way from the previous controls
  int max_iterations = 5;       ///< []
  double tolerance_m = 0.0;     ///< [] m, rms step of the controls at which to stop
};

struct LengthFit {
  Eigen::MatrixX3d controls_m;  ///< [N,3] m, camera frame
  double energy_m2 = 0.0;       ///< [] m^2, not finite where the iteration ran away
  int iterations = 0;           ///< []
};

/// The constrained step of Laplacian meshes (Ostlund et al., ECCV 2012; Ngo et al., PAMI 38(1),
/// 2016). Near an initial guess it minimises
///     E(c) = 1/2 |M P c|^2 + 1/2 stiffness^2 |A P c|^2 + 1/2 previous^2 |c - c_previous|^2
/// with edges |d_e| <= l_e. Newton's steps act on c, multipliers and slacks s_e, |d_e| + s_e^2 =
/// l_e. The term tension / 2 sum s_e^2 keeps the surface from shrinking into the camera. With
/// `equal`, Gauss-Newton steps minimise E + length_weight / 2 sum (|d_e| - l_e)^2, because there
/// are more edges than unknowns.
class LengthFitter {
 public:
  /// `previous_m` [N,3] m.
  LengthFitter(const ControlMesh& mesh, const Inliers& inliers, const LengthFitOptions& options,
               const std::optional<Eigen::MatrixX3d>& previous_m);

  LengthFit fit(const Eigen::MatrixX3d& start_m) const;

 private:
  /// Excess over the length at rest [E] m, and its derivatives by the controls.
  struct EdgeExcess {
    Eigen::VectorXd value_m;  ///< [E]
    Eigen::MatrixXd slopes;   ///< [E,3N]
  };

  EdgeExcess edge_excess(const Eigen::VectorXd& c) const;
  Eigen::VectorXd gradient(const Eigen::VectorXd& c) const;
  double energy_m2(const Eigen::VectorXd& c) const;
  Eigen::VectorXd slack_step(const Eigen::VectorXd& c, Eigen::VectorXd& slacks) const;
  Eigen::VectorXd equal_step(const Eigen::VectorXd& c) const;

  const ControlMesh& mesh_;
  LengthFitOptions options_;
  Eigen::MatrixXd quadratic_;   ///< [3N,3N] of E
  Eigen::VectorXd towards_m2_;  ///< [3N] previous^2 c_previous
  Eigen::VectorXd previous_m_;  ///< [3N] empty without
};

}  // namespace weft::solvers
