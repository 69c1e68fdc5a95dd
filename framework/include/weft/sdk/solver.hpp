// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>
#include <weft/geometry/shape_evidence.hpp>
#include <weft/sdk/export.hpp>
#include <weft/sdk/nested.hpp>
#include <weft/sdk/role.hpp>
#include <weft/sdk/welding.hpp>

namespace weft {

/// Role `solvers`: the 3D shape of the template's mesh in the camera frame, in metres, with a
/// confidence. SolverInput is in weft/sdk/nested.hpp. The host decides between `estimated` and
/// `weak` for all solvers, by state_of() in weft/geometry/shape_evidence.hpp. It keeps a state
/// `weak` of a solver and adds the evidence as `diag.agreeing_matches`, `diag.kept_matches` and
/// `diag.agreeing_coverage`.
class Solver : public Prepared {
 public:
  static constexpr const char* kRole = "solvers";
  virtual Result<Shape> solve(const SolverInput& in) = 0;

  static constexpr std::uint64_t kMethods = 0b1;
  static Role role() {
    return {kRole, {role_method<SolverInput>("solve", {output_slot<Shape>("shape")})}};
  }

  std::int32_t process(ProcessCall& call) {
    return call.run<SolverInput>("shape", [&](const SolverInput& in) {
      const bool welds = in.templ.welded_vertex.present() && joins_seams();
      return welds ? solve_welded(in) : solve(in);
    });
  }

 protected:
  /// A solver that works in the plane of the texture returns false: it receives the template with
  /// its seams, because a surface without seams has no valid `flat_px` there.
  virtual bool joins_seams() const { return true; }

 private:
  Result<Shape> solve_welded(const SolverInput& in) {
    if (auto updated = welding_.update(in.templ); !updated) return updated.error();
    const auto welded = welding_.joined(in);
    if (!welded) return welded.error();
    Result<Shape> solved = solve(*welded);
    if (solved) welding_.spread(*solved);
    return solved;
  }

  Welding welding_;  ///< places of the last template with seams
};

}  // namespace weft
