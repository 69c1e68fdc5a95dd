// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/data/record.hpp>

namespace weft {

/// The object at rest: a mesh, where each vertex lies in the texture, and the texture.
struct Template {
  static constexpr const char* kType = "template/1";
  Array<double> vertices_m;     ///< [V,3] m, template frame
  Array<double> flat_px;        ///< [V,2] px of the texture, pixel centres at integers
  Array<std::int32_t> faces;    ///< [F,3] vertex indices
  Array<double> m_per_px;       ///< [2] m per px along u and v; the mean of a curved template
  Array<std::uint8_t> texture;  ///< [H,W] or [H,W,3] grey levels or BGR
  Array<std::uint8_t> mask;     ///< [H,W] 1 where the texture belongs to the object
  std::uint64_t revision = 0;   ///< [] equal only for equal content; filled in by the host
  Others others = {};           ///< what else the record has

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
