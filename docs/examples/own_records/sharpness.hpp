// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/sdk/stage.hpp>

namespace acme {

/// How sharp each cell of an image is.
struct Sharpness {
  static constexpr const char* kType = "acme.sharpness/1";
  weft::Array<double> variance;  ///< [R,C] grey levels^2, of the Laplacian in a cell
  std::int64_t cell_px = 0;      ///< [] px, the side of a cell
  weft::Others others = {};      ///< further arrays of the record

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit(self.variance, weft::Field{"variance", "R,C", "grey levels^2", "of the Laplacian"});
    visit(self.cell_px, weft::Field{"cell_px", "", "px", "side of a cell"});
  }
};

}  // namespace acme
