// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>
#include <weft/core/params.hpp>
#include <weft/core/result.hpp>
#include <weft/data/array.hpp>
#include <weft/geometry/camera_model.hpp>

#include "common/scene/sheet_renderer.hpp"

namespace weft::frex {

/// Degradations of images by ordinary cameras and video codecs. All 0: none.
struct DegradationSettings {
  double motion_blur_px = 0.0;
  double readout_s = 0.0;
  double exposure_stops = 0.0;
  double hand_share = 0.0;
  int jpeg_quality = 0;

  /// Declares or reads all of them.
  void read(Params& p);
  bool needs_movement() const { return motion_blur_px > 0.0 || readout_s > 0.0; }
};

/// The surface in a frame, and one frame before and after it.
struct Movement {
  Points3 before_m;  ///< [V,3] m, camera frame
  Points3 now_m;     ///< [V,3] m
  Points3 after_m;   ///< [V,3] m
  double frame_s;    ///< [] s between two of them

  /// Where a vertex is some seconds after `now`, by the parabola through its three places.
  Eigen::Vector3d at(Eigen::Index vertex, double t_s) const;
};

/// The vertices [V,3] m at the moments at which a rolling shutter reads their own rows. Row v of
/// `height_px` rows is read readout_s ((v + 1/2) / height_px - 1/2) after `now`, which is thus the
/// time of the middle row. Rendered, they are the image of such a camera, linear within a triangle.
Points3 as_read(const Pinhole& camera, std::int64_t height_px, double readout_s,
                const Movement& movement);

/// The mean displacement of the vertices in the image, as a unit vector; 0 where they do not move.
Eigen::Vector2d direction_of(const Pinhole& camera, const Movement& movement);

/// The mean along a line of this length and direction in px, with the pixel in its middle. It
/// simulates a camera that turns during the exposure. The border's pixels continue beyond the
/// image.
void blur_along(const Eigen::Vector2d& along_px, scene::Picture& picture);

/// An opaque hand over the surface, which reaches into the image from below and from the right. It
/// is as large as necessary to cover this share of the surface's pixels (within 1 % of them). The
/// image has its colours, `depth_m` 0, `uv_px` NaN and hits of another mesh there. Vertices under
/// it, seen at `vertices_px` [V,2], are invisible.
void cover_by_hand(double share, bool is_grey, const Points2& vertices_px, scene::View& view);

/// The factor of an automatic exposure on the light: every five frames it steps to the next of 1,
/// 2^stops, 1, 2^-stops.
double exposure_gain(double stops, std::int64_t frame);

/// The pixels [H,W] or [H,W,3] as a JPEG of this quality (1 to 100) keeps them.
Result<void> compress(int quality, Array<std::uint8_t>& pixels);

}  // namespace weft::frex
