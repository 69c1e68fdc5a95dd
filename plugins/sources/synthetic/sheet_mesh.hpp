// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <weft/generators/developable.hpp>
#include <weft/geometry/types.hpp>

#include "common/scene/lit_mesh.hpp"

namespace weft::synthetic {

/// Texel pitch in m along u and v: the texel with centre (u,v) px lies at (x,y) = pitch * (u,v).
using Pitch = std::array<double, 2>;

/// The fine grid of triangles for rendering a surface that its texture fills from edge to edge.
class SheetMesh {
 public:
  /// Size of the texture in px.
  SheetMesh(int print_width, int print_height, Pitch pitch_m);

  const Points2& uv_px() const { return uv_px_; }  ///< [V,2] px of the texture
  const Faces& faces() const { return faces_; }    ///< [F,3]

  /// The vertices [V,3] m of a bent surface, camera frame.
  Points3 vertices_m(const DevelopableSheet& sheet) const;

 private:
  Pitch pitch_m_;
  Points2 uv_px_;
  Faces faces_;
};

/// A lamp behind the camera, up and to the left, and its surroundings.
scene::Light room_light();

}  // namespace weft::synthetic
