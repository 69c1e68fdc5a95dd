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

/// From a start to the shape that it leads to. First lengths are ten times as soft and bends are
/// held as the start has them (the convex one: as they are at rest), so that the surface comes to
/// where it is seen without creases; then all is as it should be. Where a part is hidden, the bends
/// of the shape so far are continued there, twice.
class ShapeSearch {
 public:
  Scales scales;
  MinimiserOptions options;

  /// Structure and memory for a mesh, which must outlive it. Fails on a mesh that cannot be used.
  Result<void> prepare(const Template& templ, const MeshModel& mesh);

  /// Those of the last steps.
  Scales final_scales() const;

  /// Moves the shape of a candidate, which says how it started.
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
  std::vector<std::int32_t> hinge_of_edge_;  ///< of the edges of continuation_, -1 for none
  Points3 normals_;                          ///< [F,3]
};

}  // namespace weft::gauss_newton
