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

/// How patches of bent sheets usually depart from an affine image of the patch at rest.
struct LocalModel {
  Eigen::MatrixXd modes;         ///< [n,k] orthonormal, orthogonal to 1 and to the rest shape
  Eigen::VectorXd variances_m2;  ///< [k] of a coefficient of one coordinate, largest first
};

/// Principal components of bends of a patch with the rest shape [n,3] m that lies flat at [n,2] m.
///
/// A patch in the camera frame may have any rotation. Were the training patches Y [n,3] turned by
/// all rotations R, their mean would be 0 and their covariance E[Y Y'] / 3 for each coordinate,
/// without any between coordinates, since E[(R' a)(R' b)'] = (a.b / 3) I. So the coordinates share
/// modes, and nothing is lost to sampling. With N a basis of what is orthogonal to 1 and to the
/// rest shape, affine images of which include all its rigid motions, the modes are those of
///   C = E[N' Y Y' N] / 3:
/// translations, rotations and the size are left to the image and to the lengths.
/// k = n - 4 of a curved, n - 3 of a flat patch; none where that is not above 0.
LocalModel learn_model(const Points2& flat_m, const Points3& rest_m,
                       const std::vector<IsometricBend>& bends);

/// Rows of |V^-1/2 Lambda' (X - X_rest)| (Salzmann and Fua 2011): mode_k' / sqrt(variance_k +
/// floor_m^2), [k,n] in 1/m. The floor is what any shape may depart from all modes (probabilistic
/// principal components, Tipping and Bishop 1999).
Eigen::MatrixXd prior_rows(const LocalModel& model, double floor_m);

struct LocalModelOptions {
  double turn_rad = 3.0;       ///< [] rad, usual turn of a bent sheet over its diagonal
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
