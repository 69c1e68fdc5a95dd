// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/sdk/export.hpp>
#include <weft/sdk/nested.hpp>
#include <weft/sdk/role.hpp>

namespace weft {

/// Role `solvers`: the 3D shape of the template's mesh in the camera frame, in metres. States that
/// a solver may give: estimated and weak. SolverInput is in weft/sdk/nested.hpp.
class Solver : public Prepared {
 public:
  virtual Result<Shape> solve(const SolverInput& in) = 0;

  static Role role() {
    return {"solvers", {role_method<SolverInput>("solve", {output_slot<Shape>("shape")})}};
  }

  std::int32_t process(ProcessCall& call) {
    return call.run<SolverInput>("shape", [&](const auto& in) { return solve(in); });
  }
};

}  // namespace weft
