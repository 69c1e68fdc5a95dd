// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <span>
#include <string>
#include <vector>
#include <weft/data/shape.hpp>
#include <weft/geometry/mesh_topology.hpp>
#include <weft/geometry/types.hpp>

namespace weft::overlay {

/// How a mesh is drawn.
struct MeshStyle {
  cv::Scalar colour;      ///< BGR
  double opacity = 1.0;   ///< [] 0 to 1
  int line_width_px = 1;  ///< [] px; the border of the mesh is drawn one pixel wider
};

/// Green for `estimated`, amber for `weak`, dimmed red for `predicted` and `lost`.
MeshStyle style_of(ShapeState state, int line_width_px);

/// Draws the edges of a mesh, anti-aliased, at sub-pixel positions `vertices_px` [V,2]. Edges that
/// are not seen are fainter and dashed: those of which `visible` [V] says so of both ends or, where
/// it is empty, whose faces all turn away from the camera. Edges with a vertex that is not finite
/// (it is not in front of the camera) or far outside are left out.
void draw_mesh(cv::Mat& canvas, const Points2View& vertices_px, const FacesView& faces,
               const MeshTopology& topology, std::span<const std::uint8_t> visible,
               const MeshStyle& style);

/// Draws a small dot at each of `points_px` [N,2].
void draw_points(cv::Mat& canvas, const std::vector<cv::Point2d>& points_px);

/// Writes one line of text on a dark band at the lower left.
void draw_caption(cv::Mat& canvas, const std::string& text, const cv::Scalar& colour);

}  // namespace weft::overlay
