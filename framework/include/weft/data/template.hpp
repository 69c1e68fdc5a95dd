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
  Others others = {};           ///< further arrays of the record

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit(self.vertices_m, Field{"vertices_m", "V,3", "m, template", "vertices at rest"});
    visit(self.flat_px, Field{"flat_px", "V,2", "px of the texture", "vertices in the texture"});
    visit(self.faces, Field{"faces", "F,3", "index", "triangles"});
    visit(self.m_per_px, Field{"m_per_px", "2", "m/px",
                               "texel pitch along u and v, of a curved template the mean", true});
    visit(self.texture, Field{"texture", "H,W,?", "grey level or BGR", "appearance of the object"});
    visit(self.mask, Field{"mask", "H,W", "0 or 1", "1 where the texture belongs to the object"});
  }
};

}  // namespace weft
