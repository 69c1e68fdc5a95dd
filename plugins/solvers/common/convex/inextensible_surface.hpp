// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>
#include <weft/core/params.hpp>
#include <weft/core/result.hpp>
#include <weft/geometry/distance_constraints.hpp>
#include <weft/geometry/mesh_bending.hpp>
#include <weft/geometry/mesh_topology.hpp>
#include <weft/geometry/types.hpp>
#include <weft/sdk/nested.hpp>

#include "common/convex/inextensible_program.hpp"
#include "common/convex/patch_prior.hpp"
#include "common/convex/weighed_matches.hpp"
#include "common/shape_signs.hpp"

namespace weft::solvers {

/// The data of a template that the program needs.
struct MeshAtRest {
  std::vector<DistanceConstraint> edges;
  MeshTopology topology;
  std::vector<BendingHinge> hinges;
  double mean_edge_m = 1.0;  ///< [] m
};

/// Fails on a mesh that is not valid.
Result<MeshAtRest> mesh_at_rest(const Template& templ);

/// The base of solvers that solve the InextensibleProgram in rounds. Each round excludes matches
/// with large residuals, weighs the others by their agreement, and solves again.
class InextensibleSurface {
 public:
  /// Begins with as many rounds.
  void declare(Params& p, int rounds);

  /// True if set_mesh() has been called for this template.
  bool is_for(const Template& templ) const {
    return templ.revision != 0 && templ.revision == revision_;
  }

  /// Fails where the mesh is too large.
  Result<void> set_mesh(const Template& templ, MeshAtRest mesh, PatchPrior prior = {});

  /// Needs 'correspondences' and the mesh of the template. Fails as WeighedMatches::read and
  /// InextensibleProgram::solve do.
  Result<ProgramResult> solve(const SolverInput& in, double prior_weight_px = 0.0);

  /// Vertices [V,3] m with those that are not held [V] where the mesh bends least. Fails as
  /// fill_with_least_bending does.
  Result<Points3> fill(const Template& templ, const Points3View& vertices_m,
                       const std::vector<std::uint8_t>& fixed) const;

  /// [V] 1 for vertices of faces with a match that counts.
  std::vector<std::uint8_t> vertices_with_matches() const;

  /// [V] 1 for vertices of connected parts of the mesh with a match that counts.
  std::vector<std::uint8_t> parts_with_matches() const;

  /// The record of vertices [V,3] m, with its confidence by `weights`, and the results of the
  /// program in `diag`. Fails with no_result where a vertex is not in front of the camera, and with
  /// degenerate where the program did not converge.
  Result<Shape> shape(const SolverInput& in, const ProgramResult& solved,
                      const Points3View& vertices_m, const ConfidenceWeights& weights) const;

 private:
  void explain(const ProgramResult& solved, Diagnostics& diag) const;

  ProgramOptions options_;
  int rounds_ = 1;
  double outlier_px_ = 20.0;

  std::uint64_t revision_ = 0;  ///< revision of the template to which all of this belongs
  std::vector<BendingHinge> hinges_;
  double mean_edge_m_ = 1.0;
  InextensibleProgram program_;
  WeighedMatches matches_;  ///< matches of this frame
};

}  // namespace weft::solvers
