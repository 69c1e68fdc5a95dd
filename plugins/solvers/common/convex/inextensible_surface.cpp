// SPDX-License-Identifier: Apache-2.0
#include "common/convex/inextensible_surface.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <weft/data/matrix.hpp>
#include <weft/geometry/mesh_topology.hpp>
#include <weft/geometry/mesh_validation.hpp>

#include "common/least_bending.hpp"

namespace weft::solvers {
Result<MeshAtRest> mesh_at_rest(const Template& templ) {
  const auto vertices_m = templ.vertices_m.matrix<3>();
  const auto faces = templ.faces.matrix<3>();
  if (auto valid = validate_mesh(vertices_m, faces); !valid) return valid.error();
  auto topology = build_topology(faces, vertices_m.rows());
  if (!topology) return topology.error();
  auto edges = distance_constraints(topology->edges, vertices_m);
  if (!edges) return edges.error();
  MeshAtRest mesh;
  mesh.edges = *std::move(edges);
  mesh.topology = *std::move(topology);
  mesh.hinges = bending_hinges(vertices_m, faces, mesh.topology);
  mesh.mean_edge_m = mean_edge_length(vertices_m, mesh.topology.edges);
  return mesh;
}

void InextensibleSurface::declare(Params& p, int rounds) {
  rounds_ = rounds;
  p.read(
      "depth_weight_px", options_.depth_weight_px, "px", {1e-6, 1e6},
      "weight of the summed distances of the matches, relative to the norm of their image errors");
  p.read(
      "rounds", rounds_, "", {1, 20},
      "maximum number of solves; a solve is repeated while some matches have large image errors");
  p.read(
      "outlier_px", outlier_px_, "px", {0.1, 1e6},
      "image error above which a match is excluded from the second round; halved after each round");
  p.read("tolerance", options_.tolerance, "", {1e-10, 0.1},
         "optimality gap per match at which the solver stops, relative to the distance of the "
         "surface");
  p.read("max_iterations", options_.max_iterations, "", {1, 1000000},
         "maximum number of Newton steps per round");
}

Result<void> InextensibleSurface::set_mesh(const Template& templ, MeshAtRest mesh,
                                           PatchPrior prior) {
  revision_ = 0;  // until all is made
  hinges_ = std::move(mesh.hinges);
  mean_edge_m_ = mesh.mean_edge_m;
  if (auto set =
          program_.set_mesh(templ.vertices_m.matrix<3>(), std::move(mesh.edges), std::move(prior));
      !set) {
    return set.error();
  }
  revision_ = templ.revision;
  return {};
}

Result<ProgramResult> InextensibleSurface::solve(const SolverInput& in, double prior_weight_px) {
  if (auto read = matches_.read(*in.correspondences, in.templ); !read) return read.error();
  ProgramOptions options = options_;
  options.prior_weight_px = prior_weight_px;
  auto solved = program_.solve(matches_.points(), matches_.weights(), in.camera, options);
  if (!solved) return solved;
  for (int round = 1; round < rounds_; ++round) {
    const double radius_px = std::ldexp(outlier_px_, 1 - round);  // halved each time
    if (!matches_.weigh_again(solved->vertices_m, in.camera, radius_px)) break;
    auto again = program_.solve(matches_.points(), matches_.weights(), in.camera, options);
    if (!again) break;
    solved = std::move(again);
  }
  return solved;
}

std::vector<std::uint8_t> InextensibleSurface::vertices_with_matches() const {
  return vertices_seen(matches_.points(), program_.vertex_count());
}

std::vector<std::uint8_t> InextensibleSurface::parts_with_matches() const {
  return program_.parts_seen(matches_.points());
}

Result<Points3> InextensibleSurface::fill(const Template& templ, const Points3View& vertices_m,
                                          const std::vector<std::uint8_t>& fixed) const {
  return fill_with_least_bending(templ.vertices_m.matrix<3>(), hinges_, mean_edge_m_, fixed,
                                 vertices_m);
}

Result<Shape> InextensibleSurface::shape(const SolverInput& in, const ProgramResult& solved,
                                         const Points3View& vertices_m,
                                         const ConfidenceWeights& weights) const {
  if (!(vertices_m.allFinite() && vertices_m.col(2).minCoeff() > 0.0)) {
    return no_result("the surface reaches behind the camera");
  }
  const std::vector<std::uint8_t> seen = vertices_with_matches();
  Shape shape;
  shape.vertices_m = make_array<double>(vertices_m);
  shape.source = Array<std::uint8_t>({vertices_m.rows()});
  std::copy(seen.begin(), seen.end(), shape.source.data());
  const ShapeSigns signs = shape_signs(in, program_.edges(), vertices_m);
  shape.confidence = confidence(signs, weights, in.correspondences);
  explain(solved, shape.diag);
  signs.tell(shape.diag);
  if (solved.converged) return shape;
  shape.state = static_cast<std::int32_t>(ShapeState::weak);
  return degenerate(std::move(shape), "not converged in " + std::to_string(solved.iterations) +
                                          " iterations: raise max_iterations or tolerance");
}

void InextensibleSurface::explain(const ProgramResult& solved, Diagnostics& diag) const {
  diag.set("points", static_cast<double>(matches_.points().size()));
  diag.set("iterations", solved.iterations);
  diag.set("converged", solved.converged ? 1.0 : 0.0);
  diag.set("objective_m", solved.objective_m);
  diag.set("gap_m", solved.gap_m);
  diag.set("depth_weight_px", solved.depth_weight_px);
}

}  // namespace weft::solvers
