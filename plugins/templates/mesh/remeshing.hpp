// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <weft/core/result.hpp>
#include <weft/geometry/types.hpp>

namespace weft::mesh {

/// A triangle mesh and where it lies in the texture; each face counter-clockwise as the camera sees
/// it there.
struct TexturedMesh {
  Points3 vertices_m;  ///< [V,3] m
  Points2 flat_px;     ///< [V,2] px of the texture
  Faces faces;         ///< [F,3]
};

/// The same surface in about `vertices` vertices, whose faces are about equilateral. Each chart, a
/// connected part of the texture, is meshed again in its plane, with texels of the size that they
/// have on it. Each vertex therefore has one place in the texture and on the surface: a point of a
/// face of `dense`. Sharp corners of a chart's border are kept, and between them the border up to
/// chords of the new edges. Vertices on both sides of a seam have exactly the same places, so that
/// the new surface is closed where `dense` is. Fails where so few vertices do not hold the surface;
/// `path` names it.
Result<TexturedMesh> remeshed(const std::string& path, const TexturedMesh& dense, int vertices);

}  // namespace weft::mesh
