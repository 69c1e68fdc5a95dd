// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/data/record.hpp>

namespace weft {

/// Rays on which points of the template's surface are visible.
struct Sightlines {
  static constexpr const char* kType = "sightlines/1";
  Array<std::int32_t> vertex;  ///< [M] vertex index, -1 for a point inside a face
  Array<std::int32_t> face;    ///< [M] index of the face that contains the point
  Array<double> barycentrics;  ///< [M,3] weights in that face, sum 1
  Array<double> pixel_px;      ///< [M,2] px, image position
  Array<double> ray;           ///< [M,3] unit vector, camera frame
  Array<double> weight;        ///< [M] weight in a fit; 1 is usual
  double coverage = 0.0;       ///< [] share of the template's area covered by matches, 0 to 1
  Diagnostics diag;
  Others others = {};  ///< further arrays of the record

  std::int64_t count() const { return vertex.rows(); }

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit(self.vertex, Field{"vertex", "M", "index", "vertex, -1 for a point inside a face"});
    visit(self.face, Field{"face", "M", "index", "face that holds the point"});
    visit(self.barycentrics, Field{"barycentrics", "M,3", "", "weights in that face, sum 1"});
    visit(self.pixel_px, Field{"pixel_px", "M,2", "px", "where the point is seen"});
    visit(self.ray, Field{"ray", "M,3", "unit, camera", "direction from the camera centre"});
    visit(self.weight, Field{"weight", "M", "", "trust, 1 is usual"});
    visit(self.coverage, Field{"coverage", "", "0 to 1", "share of the template's area covered"});
    visit(self.diag, Field{"diag.*", "*", "", "evidence", true});
  }
};

}  // namespace weft
