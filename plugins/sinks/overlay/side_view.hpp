// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <opencv2/core.hpp>
#include <string>
#include <vector>
#include <weft/data/template.hpp>
#include <weft/geometry/mesh_topology.hpp>
#include <weft/geometry/types.hpp>

#include "orbit.hpp"
#include "raster.hpp"

namespace weft::overlay {

/// The textured mesh as an orbiting camera sees it, above a floor with a grid and its shadow. The
/// scale is the same in all frames; the middle of the mesh is in the middle of the image.
class SideView {
 public:
  SideView() = default;
  /// `drawn` [E] selects the edges that become lines; `turn_frames` is Orbit's.
  SideView(const Template& templ, const MeshTopology& topology,
           const std::vector<std::uint8_t>& drawn, cv::Size size, int turn_frames);

  /// Renders a shape in frame `frame`; `measured` [V] is 0 where the surface is pale.
  void draw(cv::Mat panel, const Points3View& vertices_m, double confidence,
            const std::vector<double>& measured, std::uint64_t frame);
  /// Draws the empty floor, and why there is nothing on it.
  void draw_nothing(cv::Mat panel, const std::string& why, std::uint64_t frame) const;

 private:
  Eigen::Vector3d middle_of(const Points3View& vertices_m) const;
  /// Draws paper with the floor and the shadow on it.
  void draw_ground(cv::Mat& panel, const Points3View& vertices_m, std::uint64_t frame) const;
  std::vector<Corner> corners_of(const Orbit& orbit, const Points3& moved_m,
                                 const std::vector<double>& measured) const;
  void draw_mesh(const Orbit& orbit, const Points3View& vertices_m,
                 const std::vector<double>& measured);
  void label(cv::Mat& panel, const std::string& pale) const;

  int finer_ = 1;  ///< the mesh is rendered larger than the panel by this factor
  Faces faces_;    ///< [F,3]
  std::vector<std::array<bool, 3>> sides_;  ///< [F] whether the side opposite a corner is a line
  Paint paint_;                             ///< with a texel for about a pixel of the raster
  Points2 uv_px_;                           ///< [V,2] px of this texture
  double radius_m_ = 1.0;                   ///< [] m, of the template about its middle
  double grid_m_ = 0.2;                     ///< [] m between lines of the floor
  int turn_frames_ = 0;
  Raster raster_;
};

}  // namespace weft::overlay
