// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>
#include <weft/core/result.hpp>
#include <weft/data/template.hpp>
#include <weft/geometry/types.hpp>

#include "common/scene/cloth.hpp"
#include "common/scene/mip_texture.hpp"

namespace weft::frex {

/// The object before it moves.
struct RestSheet {
  Points2 uv_px;               ///< [V,2] px of the texture
  Eigen::RowVector2d pitch_m;  ///< [2] m, size of a texel
  Points3 rest_m;              ///< [V,3] m; x right, y down, z away from the camera
  Faces faces;                 ///< [F,3]
  std::vector<bool> in_hand;   ///< [V] what two hands hold at the left and the right
  int columns = 0;             ///< [] of a grid of vertices; 0 for any other mesh
  int rows = 0;                ///< []

  /// Template points of the vertices [V,2] m.
  Points2 flat_m() const { return uv_px.array().rowwise() * pitch_m.array(); }
  Result<scene::Cloth> cloth(const Points3& start_m) const;
};

/// A flat rectangle that its texture fills, as a grid of vertices.
Result<RestSheet> rectangle(const scene::MipTexture& print, double width_m, double height_m,
                            int columns, int rows);

/// A template, turned so that it faces the camera as its texture does. Fails without m_per_px.
Result<RestSheet> sheet_of(const Template& templ);

}  // namespace weft::frex
