// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/SparseCore>
#include <weft/core/result.hpp>
#include <weft/geometry/mesh_topology.hpp>
#include <weft/geometry/types.hpp>

namespace weft::solvers {

/// The regularisation matrix A of a mesh at rest. Each row holds weights, with sum 0 and norm 1, of
/// the points of two neighbouring pieces. A X = 0 holds at rest and for each affine image of it.
/// Therefore |A X| does not depend on the pose, and grows where neighbours deform differently. See
/// Ostlund, Varol, Ngo, Fua, Laplacian meshes for monocular 3D shape recovery, ECCV 2012; Ngo,
/// Ostlund, Fua, PAMI 38(1), 2016.
struct AffineRows {
  Eigen::SparseMatrix<double> rows;  ///< [R,V+M] the M virtual vertices stand behind the others
  bool flat = true;                  ///< [] without virtual vertices
};

/// A flat mesh has one row for each pair of faces with a common edge, of its four vertices. A
/// curved one has two virtual vertices for each face, in front and behind. Its rows are those of
/// the five points of two tetrahedra with a common face: the two of one face, and those around each
/// edge. A mesh within a hundredth of its size of a plane counts as flat: its pairs are laid into a
/// plane, with their lengths.
AffineRows affine_rows(const Points3View& rest_m, const FacesView& faces,
                       const MeshTopology& topology);

}  // namespace weft::solvers
