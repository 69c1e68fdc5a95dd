// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <weft/sdk/solver.hpp>

#include "gauss_newton/mesh/mesh_model.hpp"

namespace weft::gauss_newton {

/// An initial guess from the mask alone, see outline_start().
class OutlinePose final : public Solver {
 public:
  static constexpr About kAbout{.reference = "own: moments of the mask", .needs = "object_mask"};

  explicit OutlinePose(Params& /*p*/) {}

  Result<Shape> solve(const SolverInput& in) override;

 private:
  MeshModel mesh_;
  std::uint64_t mesh_revision_ = 0;
};

}  // namespace weft::gauss_newton
