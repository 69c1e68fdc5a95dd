// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>
#include <weft/testing/synthetic.hpp>

/// Surfaces that one camera sees, reconstructed with another, wrong camera.
namespace weft::testing {

/// The surface of `pipelines/sparse.yaml`, with 13 x 9 vertices.
inline constexpr SheetSpec kBentSpec{.columns = 13, .rows = 9, .height_m = 0.2, .height_px = 646};

/// A frame with known matches, and the shape that a solver would have found.
struct SeenSheet {
  Points3 vertices_m;       ///< [V,3] m, camera frame of the camera that is given
  Correspondences matches;  ///< all kept
};

/// A bent surface, turned by `turn` steps, before the camera `real` whose lens moves pixels by 1 +
/// k1 r^2. The shape is the real one, transformed so that it projects to the same pixels in the
/// camera `given`, without the lens.
inline SeenSheet see_bent_sheet(const Template& templ, const Camera& real, const Camera& given,
                                double k1, int turn, Rng& rng) {
  const double angle_rad = 0.7 * turn, tilt_rad = 0.35;
  const PoseSpec pose{0.5,
                      0.01 * turn,
                      -0.01 * turn,
                      tilt_rad * std::cos(angle_rad),
                      tilt_rad * std::sin(angle_rad),
                      0.1 * turn};
  const DevelopableSheet sheet = make_cylinder(kBentSpec, 0.2 + 0.02 * turn, 0.4 * turn, pose);
  SeenSheet seen;
  seen.vertices_m = bent_vertices(templ, sheet);
  seen.matches =
      draw_matches(templ, real, seen.vertices_m, {.count = 300, .noise_px = 0.3}, rng).matches;
  for (std::int64_t i = 0; i < seen.matches.count(); ++i) {
    const double x = (seen.matches.image_px(i, 0) - real.cx) / real.fx;
    const double y = (seen.matches.image_px(i, 1) - real.cy) / real.fy;
    const double lens = 1.0 + k1 * (x * x + y * y);
    seen.matches.image_px(i, 0) = real.fx * x * lens + real.cx;
    seen.matches.image_px(i, 1) = real.fy * y * lens + real.cy;
  }
  for (Eigen::Index v = 0; v < seen.vertices_m.rows(); ++v) {
    const Eigen::Vector2d pixel_px = project(pinhole(real), seen.vertices_m.row(v).transpose());
    const double depth_m = seen.vertices_m(v, 2) * given.fy / real.fy;
    const Eigen::Vector3d ray((pixel_px.x() - given.cx) / given.fx,
                              (pixel_px.y() - given.cy) / given.fy, 1.0);
    seen.vertices_m.row(v) = depth_m * ray.transpose();
  }
  return seen;
}

}  // namespace weft::testing
