// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/data/record.hpp>

namespace weft {

/// Which vertices the camera sees.
struct Visibility {
  static constexpr const char* kType = "visibility/1";
  Array<std::uint8_t> visible;  ///< [V] 0 or 1
  Array<double> score;          ///< [V] 0 hidden to 1 seen
  Array<std::uint8_t> reason;   ///< [V] 0 seen, 1 outside the image, 2 faces away, 3 hidden
  Diagnostics diag;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit(self.visible, Field{"visible", "V", "0 or 1", "1 where the camera sees the vertex"});
    visit(self.score, Field{"score", "V", "0 to 1", "0 hidden, 1 seen"});
    visit(self.reason,
          Field{"reason", "V", "", "0 seen, 1 outside the image, 2 faces away, 3 hidden"});
    visit(self.diag, Field{"diag.*", "*", "", "evidence", true});
  }
};

}  // namespace weft
