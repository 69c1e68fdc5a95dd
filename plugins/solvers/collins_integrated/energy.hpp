// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>
#include <weft/geometry/camera_model.hpp>
#include <weft/geometry/types.hpp>

#include "common/cholesky/block_cholesky.hpp"
#include "mesh_model.hpp"

namespace weft::collins_integrated {

/// A point of a face and its place in the image, measured in one or two directions. For a match the
/// rows of W whiten its noise. A texture sample is known only along the normal n of its edge: the
/// first row is n^T / sigma and the second is 0.
struct Observation {
  std::int32_t face = 0;                                       ///< []
  Eigen::Vector3d weights = Eigen::Vector3d::Zero();           ///< [3] in the face, sum 1
  Eigen::Vector2d seen_px = Eigen::Vector2d::Zero();           ///< [2] px
  Eigen::Matrix2d whitening_per_px = Eigen::Matrix2d::Zero();  ///< [2,2] W, 1/px
};

/// The data of one frame.
struct FrameData {
  Pinhole camera;
  std::vector<Observation> matches, texture;
  Points3 previous_m = Points3(0, 3);      ///< [V,3] m, camera frame; no rows: nothing is known
  std::vector<std::uint8_t> hidden_faces;  ///< [F] 1 for faces without any visible part; or empty
};

/// The energy of an observation with a residual of r standard deviations. Huber's loss is r^2 up to
/// `scale` and linear beyond. Tukey's is at most scale^2 / 3, beyond which the observation does not
/// count.
struct Loss {
  double scale = 2.45;      ///< [] standard deviations
  bool redescends = false;  ///< [] Tukey's

  /// Adds to the energy; returns the weight of the observation in least squares.
  double weight(double r2, double& energy) const;
};

/// How far things are usually off: standard deviations.
struct Scales {
  Loss loss;
  double strain = 0.002;    ///< [] of an edge
  double bend_rad = 0.7;    ///< [] rad, of a square of the mesh that bends, whatever its size
  double previous_m = 0.0;  ///< [] m, of a vertex from where it was; 0: any
};

/// The energy of vertices X (Collins and Bartoli, ISMAR 2015, as far as it is known),
///   sum_i rho(|W_i (pi(p_i(X)) - u_i)|)                      matches and texture samples
///   + sum_edges ((|d| - l) / (strain l))^2                   isometry
///   + sum_hinges w |B X - rest n|^2 / (3 bend_rad^2)         bending
///   + sum_v |X_v - previous_v|^2 / previous_m^2              the frame before.
/// B X is the bend of a hinge, a vector along its normal n. Derivatives treat n as constant, and
/// follow() reads it off a shape. A change of n is orthogonal to B X - rest n and would add
/// nothing.
class Energy {
 public:
  /// For a mesh, which must outlive it.
  void prepare(const MeshModel& mesh);

  /// Reads the normals of the hinges of a shape [V,3] m.
  void follow(const Points3& vertices_m);

  /// The energy; infinite where an observed point is not in front of the camera.
  double value(const FrameData& frame, const Scales& scales, const Points3& vertices_m) const;

  /// The same, with half the gradient [V,3] and the Gauss-Newton matrix.
  double linearise(const FrameData& frame, const Scales& scales, const Points3& vertices_m,
                   Points3& gradient, solvers::BlockMatrix& matrix) const;

 private:
  /// Where derivatives go.
  struct Derivatives {
    Points3* gradient = nullptr;
    solvers::BlockMatrix* matrix = nullptr;
  };
  template <bool wants_derivatives>
  double observed(const FrameData& frame, const std::vector<Observation>& observations,
                  const Loss& loss, const Points3& vertices_m, const Derivatives& to) const;
  template <bool wants_derivatives>
  double stretched(double strain, const Points3& vertices_m, const Derivatives& to) const;
  template <bool wants_derivatives>
  double bent(double bend_rad, const Points3& vertices_m, const Derivatives& to) const;
  template <bool wants_derivatives>
  double sum(const FrameData& frame, const Scales& scales, const Points3& vertices_m,
             const Derivatives& to) const;

  const MeshModel* mesh_ = nullptr;
  Points3 rest_bends_rad_;  ///< [H,3] rest n
};

}  // namespace weft::collins_integrated
