// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/core/result.hpp>
#include <weft/sdk/nested.hpp>

#include "common/coarse_mesh/coarse_mesh.hpp"
#include "prolongation.hpp"

namespace weft::coarse_to_fine {

/// Restricts the input of a solver to a coarser mesh, and prolongs its result to the fine mesh.
class CoarseProblem {
 public:
  /// Settles the mesh of about `count` vertices, fewer than the template has, by CoarseMesh.
  Result<void> build(const Template& templ, Eigen::Index count);

  /// The inputs of a solver on the coarse mesh, all of them; arrays that stay as they are are those
  /// of `in`, which must outlive the result. Fails on records of another mesh.
  Result<SolverInput> on_coarse_mesh(const SolverInput& in) const;

  /// A shape of the coarse mesh, on the fine one. Fails on one of another mesh.
  Result<Shape> on_fine_mesh(const Shape& coarse) const;

  const coarse_mesh::CoarseMesh& mesh() const { return mesh_; }

 private:
  Result<Sightlines> sightlines(const Sightlines& fine, const Template& templ) const;
  Result<KnownPoints> known_points(const KnownPoints& fine, const Template& templ) const;

  coarse_mesh::CoarseMesh mesh_;
  Prolongation prolongation_;
};

}  // namespace weft::coarse_to_fine
