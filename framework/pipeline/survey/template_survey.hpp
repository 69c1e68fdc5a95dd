// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>
#include <weft/data/template.hpp>
#include <weft/geometry/types.hpp>

namespace weft {

/// Numbers that describe a template.
struct TemplateSurvey {
  Eigen::Index vertices = 0, faces = 0, edges = 0, border_edges = 0;  ///< [] counts
  double shortest_edge_mm = 0.0, mean_edge_mm = 0.0, longest_edge_mm = 0.0;
  double least_angle_deg = 0.0;                        ///< smallest angle of a face, at rest
  double area_cm2 = 0.0;                               ///< area of all faces, at rest
  Eigen::Vector3d size_mm = Eigen::Vector3d::Zero();   ///< size of the box around it
  Eigen::Vector2d texel_mm = Eigen::Vector2d::Zero();  ///< mean along u and v
  double distortion = 0.0;                             ///< deviation of faces from that mean
  bool flat = false;                                   ///< all vertices in one plane
  std::int64_t texture_width_px = 0, texture_height_px = 0;
  double mask_share = 0.0;                 ///< share of the texture that is the object
  Eigen::Index charts = 0;                 ///< [] pieces of the texture
  Eigen::Index seam_edges = 0;             ///< [] edges at which two sides of a seam meet
  Eigen::Index open_edges = 0;             ///< [] edges on the border of the welded surface
  Eigen::Index nodes = 0, tetrahedra = 0;  ///< [] of a solid object
  double solid_cm3 = 0.0;                  ///< volume of the tetrahedra
};

/// For a template that check_template() accepts.
TemplateSurvey survey_template(const Template& templ);

/// Doubts about a template, by its numbers alone: a texture that is stretched on it.
std::vector<std::string> warnings_of(const TemplateSurvey& numbers);

}  // namespace weft
