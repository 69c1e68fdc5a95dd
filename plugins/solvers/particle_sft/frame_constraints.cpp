// SPDX-License-Identifier: Apache-2.0
#include "frame_constraints.hpp"

#include <algorithm>
#include <string>
#include <utility>
#include <weft/core/index.hpp>
#include <weft/geometry/check_sightlines.hpp>

#include "common/hidden_bend.hpp"
#include "common/known_spheres.hpp"
#include "fit.hpp"

namespace weft::particle_sft {
namespace {

/// Where the matches are wired, too few of them mean that the object is lost.
Result<void> check_match_count(const SolverInput& in) {
  if (!in.correspondences) return {};
  const Array<std::uint8_t>& kept = in.correspondences->kept;
  const auto count = kept.rows() - std::count(kept.data(), kept.data() + kept.rows(), 0);
  if (count >= kFewestMatches) return {};
  return no_result("lost: " + std::to_string(count) + " matches of at least " +
                   std::to_string(kFewestMatches));
}

}  // namespace

Result<void> FrameConstraints::read(const SolverInput& in, const MeshModel& mesh,
                                    const FrameOptions& options) {
  if (!in.sightlines) return Error{Errc::invalid_data, "needs 'sightlines'"};
  const Sightlines& lines = *in.sightlines;
  auto checked = check_sightlines(lines, mesh.vertex_count(), mesh.faces().rows());
  if (!checked) return checked;
  system.rays = ray_constraints(lines, mesh.faces());
  if (system.rays.size() < to_index(options.min_sightlines)) {
    return no_result("too few sightlines: " + std::to_string(system.rays.size()) + " of at least " +
                     std::to_string(options.min_sightlines));
  }
  if (auto enough = check_match_count(in); !enough) return enough;
  const std::vector<std::uint8_t> measured =
      observed_vertices(system.rays, {}, mesh.vertex_count());
  hidden.clear();
  if (in.visibility && options.continue_hidden_bend) {
    auto part = solvers::hidden_part(*in.visibility, measured, mesh.neighbours());
    if (!part) return part.error();
    hidden = *std::move(part);
    if (!mesh.is_flat()) solvers::add_unmeasured(measured, hidden);
  }
  if (options.continue_uncovered_bend) {
    solvers::add_uncovered(measured, mesh.neighbours(), mesh.border(), hidden);
  }
  system.spheres.clear();
  inconsistent_pairs = 0;
  if (!in.known_points) return {};
  auto spheres = known_surface_points(*in.known_points, in.templ, options.known_radius_m);
  if (!spheres) return spheres.error();
  system.spheres = *std::move(spheres);
  inconsistent_pairs = solvers::make_consistent(mesh.at_rest(), system.spheres);
  return {};
}

}  // namespace weft::particle_sft
