// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <weft/data/correspondences.hpp>
#include <weft/data/image.hpp>
#include <weft/data/known_points.hpp>

namespace weft {

/// The inputs of one frame of an embedded pipeline, all of the same undistorted camera.
struct FrameInputs {
  std::optional<Image> image{};  ///< as large as the camera's, [H,W] grey levels or [H,W,3] BGR
  std::optional<Correspondences> correspondences{};
  std::optional<KnownPoints> known_points{};
};

/// Matches between `template_px` [N,2], px of the texture, and `image_px` [N,2], px of the image.
/// `covariance_px2` [N,2,2] px^2 is that of image_px, or absent. Pipeline::process() finds the
/// faces of the mesh. Copies of the arrays share their memory.
inline Correspondences matches_between(Array<double> template_px, Array<double> image_px,
                                       Array<double> covariance_px2 = {}) {
  const std::int64_t count = template_px.rows();
  Correspondences matches;
  matches.template_px = std::move(template_px);
  matches.image_px = std::move(image_px);
  matches.covariance_px2 = std::move(covariance_px2);
  matches.face = Array<std::int32_t>({count}, -1);
  matches.barycentrics = Array<double>({count, 3}, 0.0);
  matches.kept = Array<std::uint8_t>({count}, 1);
  matches.score = Array<double>({count}, 1.0);
  return matches;
}

/// The positions `points_m` [P,3] m, camera frame, of vertices [P] of the template's mesh. They are
/// accurate to `radius_m`, m; 0: exact, negative: the tolerance that the solver has for them.
inline KnownPoints vertices_at(Array<std::int32_t> vertex, Array<double> points_m,
                               double radius_m = -1.0) {
  KnownPoints known;
  known.radius_m = Array<double>({vertex.rows()}, radius_m);
  known.vertex = std::move(vertex);
  known.points_m = std::move(points_m);
  return known;
}

}  // namespace weft
