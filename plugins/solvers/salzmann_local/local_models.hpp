// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>
#include <weft/core/result.hpp>
#include <weft/data/template.hpp>
#include <weft/geometry/types.hpp>

#include "common/convex/patch_prior.hpp"
#include "isometric_bends.hpp"
#include "local_patches.hpp"

namespace weft::salzmann_local {

/// The usual deviations of patches of bent surfaces from an affine image of the patch at rest.
struct LocalModel {
  Eigen::MatrixXd modes;         ///< [n,k] orthonormal, orthogonal to 1 and to the rest shape
  Eigen::VectorXd variances_m2;  ///< [k] of a coefficient of one coordinate, largest first
};

/// Principal components of bends of a patch with the rest shape [n,3] m that lies flat at [n,2] m.
///
/// A patch in the camera frame may have any rotation. If the training patches Y [n,3] are rotated
/// by all rotations R, their mean is 0. Their covariance is E[Y Y'] / 3 for each coordinate,
/// without any between coordinates, since E[(R' a)(R' b)'] = (a.b / 3) I. Therefore the coordinates
/// share modes, and no sampling of rotations is necessary. With N a basis of the complement of 1
/// and the rest shape, whose affine images include all its rigid motions, the modes are those of
///     C = E[N' Y Y' N] / 3.
/// Translations, rotations and the size are left to the image and to the lengths. A curved patch
/// has k = n - 4 modes and a flat patch n - 3; there are none where that is not above 0.
LocalModel learn_model(const Points2& flat_m, const Points3& rest_m,
                       const std::vector<IsometricBend>& bends);

/// Rows of |V^-1/2 Lambda' (X - X_rest)| (Salzmann and Fua 2011): mode_k' / sqrt(variance_k +
/// floor_m^2), [k,n] in 1/m. The floor is what any shape may depart from all modes (probabilistic
/// principal components, Tipping and Bishop 1999).
Eigen::MatrixXd prior_rows(const LocalModel& model, double floor_m);

struct LocalModelOptions {
  double turn_rad = 3.0;       ///< [] rad, usual turn of a bent surface over its diagonal
  double floor_edges = 0.001;  ///< [] in mean edges
  int training_shapes = 300;
  std::uint64_t seed = 2011;
};

/// The prior of a template: its patches, each with a model learned for its own layout in the
/// texture. Patches that are translates of each other share one. Fails on a face without area in
/// the texture.
Result<solvers::PatchPrior> local_models(const Template& templ, const LocalPatches& patches,
                                         double mean_edge_m, const LocalModelOptions& options);

}  // namespace weft::salzmann_local
