// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>
#include <weft/data/matrix.hpp>
#include <weft/geometry/distance_constraints.hpp>
#include <weft/geometry/mesh_validation.hpp>
#include <weft/sdk/solver.hpp>

#include "common/seen/seen_points.hpp"
#include "common/shape_signs.hpp"
#include "depth_mesh.hpp"
#include "match_depths.hpp"

namespace weft::famouri_local {
namespace {

constexpr std::size_t kFewestMatches = 10;
constexpr std::size_t kFewestDepths = 10;
// Fitted to simulated surfaces: docs/evidence/0023-confidence-of-solvers.md.
constexpr solvers::ConfidenceWeights kConfidence{.bias = -9.296,
                                                 .strain = -1.885,
                                                 .strain_p95 = -1.052,
                                                 .roughness = -0.018,
                                                 .agreeing = 0.671,
                                                 .share = 4.441,
                                                 .coverage = 3.146};

/// Depth of each match from its nearest neighbours alone, then a mesh through the points.
class FamouriLocal final : public Solver {
 public:
  static constexpr About kAbout{.reference =
                                    "reconstruction: Famouri, Bartoli, Azimifar, Fast "
                                    "shape-from-template using local features, Machine "
                                    "Vision and Applications 29 (2018)",
                                .needs = "correspondences",
                                .reads = ""};

  explicit FamouriLocal(Params& p) {
    p.read("neighbours", depth_.neighbours, "", {4, 100},
           "maximum number of matches in the fit of a local map, including its own match");
    p.read("reach", depth_.reach, "", {0.001, 10.0},
           "maximum distance of a neighbour from its match, relative to the template's diagonal");
    p.read("bend_rad", depth_.bend_rad, "rad", {0.0, 1000.0},
           "expected bend of the local maps along the template's diagonal; 0: affine maps");
    p.read("stiffness", fit_.stiffness, "", {1e-6, 1e6},
           "weight of the squared curvature of the mesh, integrated over its area");
    p.read(
        "mesh_error_px", fit_.mesh_error_px, "px", {0.001, 1000.0},
        "standard deviation of the distance of matches from the mesh, in addition to match noise");
  }

  Result<Shape> solve(const SolverInput& in) override {
    if (!in.correspondences) return Error{Errc::invalid_data, "needs 'correspondences'"};
    if (auto ready = prepare_mesh(in.templ); !ready) return ready.error();
    const auto points = solvers::seen_points(*in.correspondences, in.templ, kFewestMatches);
    if (!points) return points.error();
    const auto rest_m = in.templ.vertices_m.matrix<3>();
    const double frontal_m = solvers::frontal_distance_m(*points, in.camera, rest_m);
    if (!std::isfinite(frontal_m)) {
      return no_result("the matches coincide in the image: the depth is not bounded");
    }
    const MatchDepths& found = finder_.find(*points, in.camera, rest_m, frontal_m, depth_);
    if (found.depths.size() < kFewestDepths) {
      return no_result("the depth is known at " + std::to_string(found.depths.size()) +
                       " matches of at least " + std::to_string(kFewestDepths));
    }
    const auto vertices_m = mesh_.fit(found, in.camera, fit_);
    if (!vertices_m) return vertices_m.error();
    if (!(vertices_m->col(2).minCoeff() > 0.0)) {
      return no_result("the surface reaches behind the camera");
    }
    return build_shape(in, *vertices_m, found);
  }

 private:
  Result<void> prepare_mesh(const Template& templ) {
    if (templ.revision != 0 && templ.revision == revision_) return {};
    revision_ = 0;  // until all is made
    const auto vertices_m = templ.vertices_m.matrix<3>();
    const auto faces = templ.faces.matrix<3>();
    if (auto valid = validate_mesh(vertices_m, faces); !valid) return valid.error();
    const auto topology = build_topology(faces, vertices_m.rows());
    if (!topology) return topology.error();
    auto edges = distance_constraints(topology->edges, vertices_m);
    if (!edges) return edges.error();
    edges_ = *std::move(edges);
    if (auto set = mesh_.set_mesh(vertices_m, faces, *topology); !set) return set.error();
    revision_ = templ.revision;
    return {};
  }

  Result<Shape> build_shape(const SolverInput& in, const Points3& vertices_m,
                            const MatchDepths& found) const {
    Shape shape;
    shape.vertices_m = make_array<double>(vertices_m);
    shape.source = Array<std::uint8_t>({vertices_m.rows()});
    const std::vector<std::uint8_t> seen = solvers::vertices_seen(found.points, vertices_m.rows());
    std::copy(seen.begin(), seen.end(), shape.source.data());
    const solvers::ShapeSigns signs = solvers::shape_signs(in, edges_, vertices_m);
    double std_m = 0.0;
    for (const LocalDepth& depth : found.depths) std_m += depth.std_m;
    std_m /= static_cast<double>(found.depths.size());
    shape.confidence = solvers::confidence(signs, kConfidence, in.correspondences);
    shape.diag.set("depths", static_cast<double>(found.depths.size()));
    shape.diag.set("contradicting_matches", found.contradicting);
    shape.diag.set("undetermined_depths", found.undetermined);
    shape.diag.set("folded_depths", found.folded);
    shape.diag.set("odd_depths", found.odd);
    shape.diag.set("depth_std_m", std_m);
    shape.diag.set("noise_px", found.noise_px);
    signs.tell(shape.diag);
    return shape;
  }

  DepthOptions depth_;
  FitOptions fit_;

  std::uint64_t revision_ = 0;  ///< revision of the template to which all of this belongs
  std::vector<DistanceConstraint> edges_;
  DepthFinder finder_;
  DepthMesh mesh_;
};

}  // namespace
}  // namespace weft::famouri_local

using weft::famouri_local::FamouriLocal;
WEFT_PLUGIN(
    FamouriLocal, "solvers/famouri_local", "1.1.0",
    "Computes the depth of each match from its nearest neighbours and fits a mesh to the points.")
