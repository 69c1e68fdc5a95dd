// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>
#include <weft/core/result.hpp>
#include <weft/data/template.hpp>
#include <weft/geometry/types.hpp>

#include "common/scene/cloth.hpp"
#include "common/scene/mip_texture.hpp"
#include "film/welding.hpp"

namespace weft::frex {

/// The object before it moves.
struct RestSheet {
  Points2 uv_px;                    ///< [V,2] px of the texture
  Eigen::RowVector2d pitch_m;       ///< [2] m, size of a texel
  Points3 rest_m;                   ///< [V,3] m; x right, y down, z away from the camera
  Faces faces;                      ///< [F,3]
  std::vector<bool> in_hand;        ///< [V] what two hands hold at the left and the right
  std::vector<std::int32_t> first;  ///< [V] first vertex at the same place; empty without seams
  bool is_unrolled = true;  ///< neighbours on the surface are neighbours in the texture: no seams
  int columns = 0;          ///< [] of a grid of vertices; 0 for any other mesh
  int rows = 0;             ///< []

  /// Template points of the vertices [V,2] m.
  Points2 flat_m() const { return uv_px.array().rowwise() * pitch_m.array(); }
  Result<scene::Cloth> cloth(const Points3& start_m) const;
  /// The same surface with one vertex for each place, without seams.
  RestSheet welded(const Welding& welding) const;
};

/// A flat rectangle that its texture fills, as a grid of vertices.
Result<RestSheet> rectangle(const scene::MipTexture& print, double width_m, double height_m,
                            int columns, int rows);

/// Fails if the object has no m_per_px: its truth would have no place on the template.
Result<void> check_pitch(const Template& object);

/// A template, turned so that it faces the camera as its texture does, or its largest chart if it
/// has several. Fails without m_per_px.
Result<RestSheet> sheet_of(const Template& templ);

}  // namespace weft::frex
