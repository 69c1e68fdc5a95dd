// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/data/record.hpp>

namespace weft {

/// The object at rest: a mesh, the texture positions of its vertices, and the texture.
struct Template {
  static constexpr const char* kType = "template/1";
  Array<double> vertices_m;     ///< [V,3] m, template frame
  Array<double> flat_px;        ///< [V,2] px of the texture, pixel centres at integers
  Array<std::int32_t> faces;    ///< [F,3] vertex indices
  Array<double> m_per_px;       ///< [2] m per px along u and v; the mean for a curved template
  Array<std::uint8_t> texture;  ///< [H,W] grey levels or [H,W,3] BGR, 0 to 255
  Array<std::uint8_t> mask;     ///< [H,W] 1 where the texture belongs to the object
  std::uint64_t revision = 0;   ///< [] equal only for equal content; set by the host
  Array<std::int32_t> welded_vertex = {};  ///< [V] first vertex at the same place, itself included
  Array<double> nodes_m = {};              ///< [K,3] m, template frame, corners of the tetrahedra
  Array<std::int32_t> tetrahedra = {};     ///< [E,4] node indices, of positive volume
  Array<std::int32_t> vertex_tetrahedron = {};  ///< [V] tetrahedron that carries the vertex
  Array<double> vertex_barycentric = {};        ///< [V,4] weights of its corners, their sum is 1
  Others others = {};                           ///< further arrays of the record

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit(self.vertices_m, Field{"vertices_m", "V,3", "m, template", "vertices at rest"});
    visit(self.flat_px, Field{"flat_px", "V,2", "px of the texture", "vertices in the texture"});
    visit(self.faces, Field{"faces", "F,3", "index", "triangles"});
    visit(self.m_per_px, Field{"m_per_px", "2", "m/px",
                               "texel pitch along u and v, of a curved template the mean", true});
    visit(self.texture, Field{"texture", "H,W,?", "grey level or BGR", "appearance of the object"});
    visit(self.mask, Field{"mask", "H,W", "0 or 1", "1 where the texture belongs to the object"});
    visit(self.welded_vertex,
          Field{"welded_vertex", "V", "index",
                "first vertex at the same place; vertices on both sides of a seam share it", true});
    visit(self.nodes_m, Field{"nodes_m", "K,3", "m, template",
                              "corners of the tetrahedra of a solid object at rest", true});
    visit(self.tetrahedra, Field{"tetrahedra", "E,4", "index",
                                 "nodes of each tetrahedron, of positive volume", true});
    visit(self.vertex_tetrahedron,
          Field{"vertex_tetrahedron", "V", "index", "tetrahedron that carries the vertex", true});
    visit(self.vertex_barycentric,
          Field{"vertex_barycentric", "V,4", "",
                "weights of the tetrahedron's corners at the vertex; their sum is 1", true});
  }

  /// Returns whether the object is solid: the surface is embedded in tetrahedra.
  bool is_solid() const { return tetrahedra.present(); }
};

}  // namespace weft
