// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <span>
#include <vector>
#include <weft/data/shape.hpp>
#include <weft/geometry/mesh_topology.hpp>
#include <weft/geometry/types.hpp>

namespace weft::overlay {

/// The style of a mesh.
struct MeshStyle {
  cv::Scalar colour;      ///< BGR
  double opacity = 1.0;   ///< [] 0 to 1
  int line_width_px = 1;  ///< [] px
};

/// The colour of the confidence; a shape that was not measured in this frame is fainter.
MeshStyle style_of(const Shape& shape, int line_width_px);

/// [E] 1 for the edges that become lines: all but those that halve a rectangle of the rest shape.
std::vector<std::uint8_t> drawn_edges(const Points3View& rest_m, const MeshTopology& topology);

/// Draws the edges of a mesh that `drawn` [E] selects, anti-aliased, at sub-pixel positions
/// `vertices_px` [V,2]; inner edges are fainter than the border. Hidden edges are fainter still and
/// dashed. An edge is hidden if `visible` [V] is 0 at both ends or, where it is empty, if all its
/// faces turn away from the camera. Edges with a vertex that is not finite (it is not in front of
/// the camera) or far outside are omitted.
void draw_mesh(cv::Mat& canvas, const Points2View& vertices_px, const FacesView& faces,
               const MeshTopology& topology, const std::vector<std::uint8_t>& drawn,
               std::span<const std::uint8_t> visible, const MeshStyle& style);

/// Draws a small dot at each of `points_px` [N,2].
void draw_points(cv::Mat& canvas, const std::vector<cv::Point2d>& points_px);

}  // namespace weft::overlay
