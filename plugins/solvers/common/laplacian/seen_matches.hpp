// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>
#include <weft/core/result.hpp>
#include <weft/data/correspondences.hpp>
#include <weft/geometry/camera_model.hpp>
#include <weft/geometry/types.hpp>

#include "common/laplacian/control_mesh.hpp"

namespace weft::solvers {

/// The kept matches that lie on the mesh, as places of a mesh that controls C [N,3] m move: match m
/// is at the point weights.row(m) C.
struct SeenMatches {
  Pinhole camera;
  std::vector<std::int32_t> faces;   ///< [M]
  std::vector<std::int64_t> places;  ///< [M] rows of the record
  std::int64_t record_count = 0;     ///< [] matches of the record
  Eigen::MatrixXd weights;           ///< [M,N]
  Points2 seen_px;                   ///< [M,2] px
  Points2 slopes;                    ///< [M,2] x / z and y / z on the sightline

  Eigen::Index count() const { return weights.rows(); }
};

/// Fails on numbers that are not finite and on faces that the mesh lacks.
Result<SeenMatches> read_matches(const Correspondences& matches, const Pinhole& camera,
                                 const ControlMesh& mesh);

/// [3N,3N] (M P)^T W (M P) with a weight [M] for each match, for c = (x.., y.., z..) of the
/// controls. M X = 0 where each match is on its sightline. With the slopes (a, b) of the sightline,
/// the rows are x - a z and y - b z in m. These are the paper's rows divided by the focal length.
Eigen::MatrixXd reprojection_matrix(const SeenMatches& matches, const Eigen::VectorXd& counts);

/// [M] px, from where each match was seen to where the shape of the controls has it; infinite
/// behind the camera.
Eigen::VectorXd distances_px(const SeenMatches& matches, const Eigen::MatrixX3d& controls_m);

/// Adds `factor` times a matrix [N,N] for each coordinate of the controls to one of [3N,3N].
void add_for_each_axis(const Eigen::MatrixXd& matrix, double factor, Eigen::MatrixXd& sum);

/// True if points [M,D] are in one place or on a line, within a thousandth of its length.
bool on_a_line(const Eigen::MatrixXd& points);

}  // namespace weft::solvers
