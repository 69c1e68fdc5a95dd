// SPDX-License-Identifier: Apache-2.0
#include "common/laplacian/laplacian_front.hpp"

#include <utility>

namespace weft::solvers {

void LaplacianFront::declare(Params& p, Preset preset) {
  if (preset == Preset::weft) {
    controls_ = 40;
    search_.affine_test = true;
  }
  p.read(
      "controls", controls_, "", {4, 200},
      "number of control vertices, evenly spread over the mesh, that determine the other vertices");
  p.read(
      "reject_outliers", search_.rejects,
      "outlier rejection by the solver, without a filter before it; false: all kept matches count");
  p.read("affine_test", search_.affine_test,
         "rejection, before the first test, of matches far from the affine map of least distances");
  p.read("radius_px", search_.radius_px, "px", {0.5, 1000.0},
         "distance from the surface of the last test above which a match is an outlier");
  p.read("tests", search_.tests, "", {1, 10},
         "number of tests of the matches, each with half the radius and half the stiffness of the "
         "previous one");
  p.read("stiffness", search_.stiffness, "", {1e-3, 1e3},
         "weight of the regularisation in the linear shape after the last test");
  p.read("min_matches", search_.fewest, "", {4, 1000000}, "minimum number of inliers for a result");
}

Result<void> LaplacianFront::read(const SolverInput& in) {
  if (!in.correspondences) return Error{Errc::invalid_data, "needs 'correspondences'"};
  if (in.templ.revision == 0 || in.templ.revision != revision_) {
    revision_ = 0;  // until all is made
    auto mesh = make_control_mesh(in.templ, controls_);
    if (!mesh) return mesh.error();
    mesh_ = *std::move(mesh);
    revision_ = in.templ.revision;
  }
  auto matches = read_matches(*in.correspondences,
                              {in.camera.fx, in.camera.fy, in.camera.cx, in.camera.cy}, mesh_);
  if (!matches) return matches.error();
  matches_ = *std::move(matches);
  auto inliers = find_inliers(mesh_, matches_, search_);
  if (!inliers) return inliers.error();
  inliers_ = *std::move(inliers);
  return {};
}

}  // namespace weft::solvers
