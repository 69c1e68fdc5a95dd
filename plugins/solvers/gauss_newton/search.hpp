// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>
#include <weft/core/result.hpp>
#include <weft/data/template.hpp>

#include "candidate.hpp"
#include "common/hidden_bend.hpp"
#include "energy.hpp"
#include "frame.hpp"
#include "mesh/mesh_model.hpp"
#include "minimiser.hpp"

namespace weft::gauss_newton {

/// Optimises a shape from an initial guess. The first stage makes lengths ten times softer, so that
/// the surface reaches its observations without creases. It keeps the bends of the initial guess,
/// or those at rest for the convex guess. The second stage uses the full energy. Where a part is
/// hidden, the bends of the shape so far are continued there, twice.
class ShapeSearch {
 public:
  Scales scales;
  MinimiserOptions options;

  /// Structure and memory for a mesh, which must outlive it. Fails on a mesh that cannot be used.
  Result<void> prepare(const Template& templ, const MeshModel& mesh);

  /// Those of the last steps.
  Scales final_scales() const;

  /// Optimises the shape of a candidate, which has the kind of its initial guess.
  void run(const Frame& frame, Candidate& candidate);

  Energy& energy() { return minimiser_.energy(); }
  BlockCholesky& factor() { return minimiser_.factor(); }

 private:
  void expect_bends_of_start(const Candidate& candidate);
  void expect_bends(const Frame& frame, const Points3& vertices_m);

  const MeshModel* mesh_ = nullptr;
  Minimiser minimiser_;
  Expectation expected_;
  solvers::BendContinuation continuation_;
  std::vector<std::int32_t> hinge_of_edge_;  ///< hinge of each of the edges of continuation_, -1
                                             ///< for none
  Points3 normals_;                          ///< [F,3]
};

}  // namespace weft::gauss_newton
