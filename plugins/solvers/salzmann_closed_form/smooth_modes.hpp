// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>
#include <weft/geometry/mesh_bending.hpp>
#include <weft/geometry/types.hpp>

namespace weft::salzmann_closed_form {

/// Functions on the vertices of a mesh, in which its shapes are combined: first
/// those that are affine in its places at rest, then the ones that bend it
/// least.
struct SmoothModes {
  Eigen::MatrixXd values;    ///< [V,m] orthonormal columns
  Eigen::VectorXd energies;  ///< [m] bending energy of each, 0 of the affine
                             ///< ones, then ascending
};

/// At most `count` modes. The modes beyond 1, x, y and z at rest follow from the bending energy K
/// of the mesh. With the projection P on the complement of these four, they are the eigenvectors of
/// P K P with the smallest eigenvalues, by subspace iteration (Bathe and Wilson, 1972). Therefore a
/// curved rest shape, and all its affine images, cost nothing.
SmoothModes smooth_modes(const Points3View& rest_m, const std::vector<BendingHinge>& hinges,
                         int count);

}  // namespace weft::salzmann_closed_form
