// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <weft/core/params.hpp>
#include <weft/core/result.hpp>
#include <weft/sdk/nested.hpp>

#include "common/laplacian/control_mesh.hpp"
#include "common/laplacian/inlier_search.hpp"
#include "common/laplacian/seen_matches.hpp"
#include "common/preset/preset.hpp"

namespace weft::solvers {

/// The common first steps of solvers on Laplacian meshes. It has the control mesh of the template,
/// which is kept while its revision stays, the matches of a frame, and their inliers.
class LaplacianFront {
 public:
  /// Begins with the constants of the preset.
  void declare(Params& p, Preset preset);

  /// Needs 'correspondences'. Fails as make_control_mesh, read_matches and find_inliers do.
  Result<void> read(const SolverInput& in);

  const ControlMesh& mesh() const { return mesh_; }
  const SeenMatches& matches() const { return matches_; }
  const Inliers& inliers() const { return inliers_; }

 private:
  int controls_ = 25;
  InlierSearchOptions search_;
  std::uint64_t revision_ = 0;  ///< revision of the template of the mesh
  ControlMesh mesh_;
  SeenMatches matches_;
  Inliers inliers_;
};

}  // namespace weft::solvers
