// SPDX-License-Identifier: Apache-2.0
#include "match_sightlines.hpp"

#include <algorithm>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/camera_model.hpp>

namespace weft::brunet_refine {

Sightlines match_sightlines(const Correspondences& matches, const Camera& camera,
                            std::int64_t face_count) {
  std::vector<std::int64_t> on_mesh;
  for (std::int64_t i = 0; i < matches.count(); ++i) {
    if (matches.kept(i) != 0 && matches.face(i) >= 0) on_mesh.push_back(i);
  }
  const auto count = static_cast<std::int64_t>(on_mesh.size());
  Sightlines lines;
  lines.vertex = Array<std::int32_t>({count}, -1);
  lines.face = Array<std::int32_t>({count});
  lines.barycentrics = Array<double>({count, 3});
  lines.pixel_px = Array<double>({count, 2});
  lines.ray = Array<double>({count, 3});
  lines.weight = Array<double>({count}, 1.0);
  std::vector<std::uint8_t> covered(to_index(face_count), 0);
  const Pinhole pinhole{camera.fx, camera.fy, camera.cx, camera.cy};
  for (std::int64_t k = 0; k < count; ++k) {
    worked_in_loop(k, 3);
    const std::int64_t i = on_mesh[to_index(k)];
    const Eigen::Vector2d pixel_px = matches.image_px.matrix<2>().row(i);
    lines.face(k) = matches.face(i);
    lines.barycentrics.matrix<3>().row(k) = matches.barycentrics.matrix<3>().row(i);
    lines.pixel_px.matrix<2>().row(k) = pixel_px.transpose();
    lines.ray.matrix<3>().row(k) = unit_ray(pinhole, pixel_px).transpose();
    covered[to_index(matches.face(i))] = 1;
  }
  lines.coverage = static_cast<double>(std::count(covered.begin(), covered.end(), 1)) /
                   static_cast<double>(face_count);
  return lines;
}

}  // namespace weft::brunet_refine
