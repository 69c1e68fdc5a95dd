// SPDX-License-Identifier: Apache-2.0
#include "outline_pose.hpp"

#include <weft/data/matrix.hpp>

#include "outline_start.hpp"

namespace weft::gauss_newton {

Result<Shape> OutlinePose::solve(const SolverInput& in) {
  if (mesh_revision_ == 0 || in.templ.revision != mesh_revision_) {
    mesh_revision_ = 0;
    if (auto built = mesh_.build(in.templ, 0.0); !built) return built.error();
    mesh_revision_ = in.templ.revision;
  }
  const Pinhole camera{in.camera.fx, in.camera.fy, in.camera.cx, in.camera.cy};
  const auto placed_m = outline_start(*in.object_mask, camera, mesh_);
  if (!placed_m) return no_result("the mask shows no object");
  Shape shape;
  shape.vertices_m = make_array<double>(*placed_m);
  shape.state = static_cast<std::int32_t>(ShapeState::weak);
  shape.source = Array<std::uint8_t>({mesh_.vertex_count()}, 0);
  return shape;
}

}  // namespace weft::gauss_newton
