// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/data/record.hpp>

namespace weft {

/// Surface points with known 3D positions, for example under a robot's gripper.
struct KnownPoints {
  static constexpr const char* kType = "known_points/1";
  Array<std::int32_t> vertex;  ///< [P] index, -1 for a point given by template_xy_m
  Array<double> points_m;      ///< [P,3] m, camera frame
  Array<double> radius_m;      ///< [P] m, tolerance radius; 0: exact, negative: the solver's own
  Array<double> template_xy_m = {};  ///< [P,2] m, m_per_px * (u,v); read if the vertex is -1
  Array<std::int32_t> face = {};     ///< [P] face that holds the point, -1 for none
  Array<double> barycentrics = {};   ///< [P,3] weights in that face, sum 1
  Others others = {};                ///< further arrays of the record

  std::int64_t count() const { return vertex.rows(); }

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit(self.vertex, Field{"vertex", "P", "index", "vertex, -1 for a point of the template"});
    visit(self.points_m, Field{"points_m", "P,3", "m, camera", "known position"});
    visit(self.radius_m, Field{"radius_m", "P", "m",
                               "the point lies within; 0 is exact, below 0 the solver's own"});
    visit(self.template_xy_m,
          Field{"template_xy_m", "P,2", "m", "m_per_px * (u,v) where the vertex is -1", true});
    visit(self.face, Field{"face", "P", "index",
                           "face that holds the point, -1 for none; replaces template_xy_m", true});
    visit(self.barycentrics, Field{"barycentrics", "P,3", "", "weights in that face, sum 1", true});
  }
};

}  // namespace weft
