// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/data/record.hpp>

namespace weft {

/// True 3D positions of template points. Only sinks, the evaluation and components that declare
/// `uses_truth` may read it.
struct GroundTruth {
  static constexpr const char* kType = "ground_truth/1";
  Array<double>
      template_xy_m;       ///< [T,2] m, m_per_px * (u,v); the centre of the top-left texel is (0,0)
  Array<double> points_m;  ///< [T,3] m, camera frame
  std::string kind;        ///< [n] measurement method of the truth; groups the rows of reports
  std::string exclusion;   ///< [n] reason why the frame is reported separately; empty if it is not
  Array<std::int32_t> faces = {};    ///< [F,3] faces of the true surface over the points
  Array<std::uint8_t> visible = {};  ///< [T] 1 where the camera sees the point
  Array<float> depth_m = {};         ///< [H,W] m, along the optical axis; 0 where unknown
  Array<float> uv_m =
      {};  ///< [H,W,2] m, template point visible at the pixel; NaN where there is none
  Array<double> match_xy_px =
      {};  ///< [N,2] px, true image of the source's matches; NaN where unknown
  Array<std::int8_t> match_label =
      {};                      ///< [N] of the source's matches: 1 inlier, 0 outlier, -1 unknown
  Array<double> cloud_m = {};  ///< [P,3] m, camera frame, on the surface; template points unknown
  Array<std::int32_t> cloud_faces = {};  ///< [G,3] faces of the surface over the cloud's points
  Array<std::uint8_t> part_names =
      {};  ///< [n] names of the parts that are scored separately, one per line
  Array<std::int32_t> point_part = {};  ///< [T] index of each true point's part, -1 for none
  Array<std::int32_t> cloud_part = {};  ///< [P] index of each cloud point's part, -1 for none
  Diagnostics diag = {};
  Others others = {};  ///< further arrays of the record

  std::int64_t count() const { return template_xy_m.rows(); }
  /// The names of the parts, in the order of the indices in `point_part` and `cloud_part`.
  std::vector<std::string> parts() const {
    std::vector<std::string> names;
    for (std::int64_t i = 0; part_names.present() && i < part_names.rows(); ++i) {
      const char letter = static_cast<char>(part_names(i));
      if (i == 0 || letter == '\n') names.emplace_back();
      if (letter != '\n') names.back().push_back(letter);
    }
    return names;
  }

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit(self.template_xy_m, Field{"template_xy_m", "T,2", "m", "m_per_px * (u,v)"});
    visit(self.points_m, Field{"points_m", "T,3", "m, camera", "true positions"});
    visit(self.kind, Field{"kind", "*", "", "how the truth was measured"});
    visit(self.exclusion,
          Field{"apart", "*", "", "why the frame is reported separately, or empty"});
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
    visit(self.cloud_m, Field{"cloud_m", "P,3", "m, camera",
                              "points of the surface without a known place on it", true});
    visit(self.cloud_faces,
          Field{"cloud_faces", "G,3", "index", "triangles over the points of the cloud", true});
    visit(self.part_names,
          Field{"part_names", "*", "", "parts that are scored separately, one a line", true});
    visit(self.point_part,
          Field{"point_part", "T", "index", "part of each true point, -1 for none", true});
    visit(self.cloud_part,
          Field{"cloud_part", "P", "index", "part of each point of the cloud, -1 for none", true});
    visit(self.diag, Field{"diag.*", "*", "", "evidence", true});
  }
};

}  // namespace weft
