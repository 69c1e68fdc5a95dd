// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/data/record.hpp>

namespace weft {

/// Vertices whose 3D position is known, for example held by a robot's gripper.
struct KnownPoints {
  static constexpr const char* kType = "known_points/1";
  Array<std::int32_t> vertex;  ///< [P] index
  Array<double> points_m;      ///< [P,3] m, camera frame
  Array<double> radius_m;      ///< [P] m, the vertex lies within; 0 holds it exactly

  std::int64_t count() const { return vertex.rows(); }

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit(self.vertex, Field{"vertex", "P", "index", "vertex of the template"});
    visit(self.points_m, Field{"points_m", "P,3", "m, camera", "known position"});
    visit(self.radius_m, Field{"radius_m", "P", "m", "the vertex lies within; 0 is exact"});
  }
};

}  // namespace weft
