// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/data/record.hpp>

namespace weft {

/// Solvers set `estimated` and `weak`; only the host sets `predicted` and `lost`.
enum class ShapeState : std::int32_t { none = 0, estimated = 1, weak = 2, predicted = 3, lost = 4 };

inline const char* to_string(ShapeState state) {
  constexpr const char* kNames[] = {"none", "estimated", "weak", "predicted", "lost"};
  const auto index = static_cast<std::int32_t>(state);
  return index >= 0 && index <= 4 ? kNames[index] : "invalid";
}

/// The template's mesh in the camera frame.
struct Shape {
  static constexpr const char* kType = "shape/1";
  Array<double> vertices_m;     ///< [V,3] m, camera frame
  std::int32_t state = 1;       ///< [] ShapeState
  std::int64_t age_frames = 0;  ///< [] frames since the last measurement
  double confidence = 1.0;      ///< [] 0 to 1, see the catalogue
  Array<std::uint8_t> source;   ///< [V] 1 measured, 0 filled in by the prior
  Array<double> covariance_m2;  ///< [V,3,3] m^2, camera frame
  Diagnostics diag;
  Array<double> nodes_m = {};  ///< [K,3] m, camera frame, nodes of the template's tetrahedra
  Others others = {};          ///< further arrays of the record

  ShapeState shape_state() const { return static_cast<ShapeState>(state); }

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit(self.vertices_m, Field{"vertices_m", "V,3", "m, camera", "vertices"});
    visit(self.state, Field{"state", "", "", "1 estimated, 2 weak, 3 predicted, 4 lost"});
    visit(self.age_frames, Field{"age", "", "frames", "since it was measured"});
    visit(self.confidence, Field{"confidence", "", "0 to 1",
                                 "probability that the mean error of the visible part is below 2 % "
                                 "of the template's diagonal; 0 where not measured in this frame"});
    visit(self.source, Field{"source", "V", "0 or 1", "1 measured, 0 filled in by the prior"});
    visit(self.covariance_m2,
          Field{"covariance_m2", "V,3,3", "m^2, camera", "of each vertex", true});
    visit(self.nodes_m,
          Field{"nodes_m", "K,3", "m, camera", "nodes of the template's tetrahedra", true});
    visit(self.diag, Field{"diag.*", "*", "", "evidence", true});
  }
};

}  // namespace weft
