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

  std::int64_t count() const { return template_xy_m.rows(); }

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit(self.template_xy_m, Field{"template_xy_m", "T,2", "m", "m_per_px * (u,v)"});
    visit(self.points_m, Field{"points_m", "T,3", "m, camera", "true positions"});
    visit(self.kind, Field{"kind", "*", "", "how the truth was measured"});
    visit(self.apart, Field{"apart", "*", "", "why the frame is reported apart, or empty"});
  }
};

}  // namespace weft
