// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/data/record.hpp>

namespace weft {

/// True 3D positions of points of the template. Only sinks, the evaluation and components that
/// declare `uses_truth` may read it.
struct GroundTruth {
  static constexpr const char* kType = "ground_truth/1";
  Array<double> template_xy_m;  ///< [T,2] m, m_per_px * (u,v): the top-left texel's centre is (0,0)
  Array<double> points_m;       ///< [T,3] m, camera frame
  std::string kind;             ///< [n] how the truth was measured; groups the report
  std::string apart;            ///< [n] why the frame is reported apart; empty if it is not
  Array<std::int32_t> faces = {};    ///< [F,3] the points are the corners of the true surface
  Array<std::uint8_t> visible = {};  ///< [T] 1 where the camera sees the point
  Array<float> depth_m = {};         ///< [H,W] m along the optical axis, 0 where it is not known
  Array<float> uv_m = {};  ///< [H,W,2] m, template point seen at the pixel, NaN where none is
  Array<double> match_xy_px = {};  ///< [N,2] px, true image of the source's matches, or NaN
  Array<std::int8_t> match_label =
      {};  ///< [N] of the source's matches: 1 correct, 0 mismatch, -1 unknown
  Diagnostics diag = {};

  std::int64_t count() const { return template_xy_m.rows(); }

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit(self.template_xy_m, Field{"template_xy_m", "T,2", "m", "m_per_px * (u,v)"});
    visit(self.points_m, Field{"points_m", "T,3", "m, camera", "true positions"});
    visit(self.kind, Field{"kind", "*", "", "how the truth was measured"});
    visit(self.apart, Field{"apart", "*", "", "why the frame is reported apart, or empty"});
    visit(self.faces, Field{"faces", "F,3", "index", "triangles over the true points", true});
    visit(self.visible, Field{"visible", "T", "0 or 1", "1 where the camera sees the point", true});
    visit(self.depth_m,
          Field{"depth_m", "H,W", "m", "along the optical axis, 0 where it is not known", true});
    visit(self.uv_m, Field{"uv_m", "H,W,2", "m", "template point seen at the pixel", true, true});
    visit(self.match_xy_px,
          Field{"match_xy_px", "N,2", "px", "true image of the source's matches", true, true});
    visit(self.match_label,
          Field{"match_label", "N", "-1, 0 or 1",
                "of the source's matches: correct 1, mismatch 0, unknown -1", true});
    visit(self.diag, Field{"diag.*", "*", "", "evidence", true});
  }
};

}  // namespace weft
