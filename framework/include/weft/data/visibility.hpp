// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/data/record.hpp>

namespace weft {

/// Why a vertex is taken to be seen or not.
enum class SightReason : std::uint8_t {
  seen = 0,
  outside = 1,      ///< beyond the image, or behind the camera
  faces_away = 2,   ///< all faces around it show their back
  hidden = 3,       ///< something stands before it
  unconfirmed = 4,  ///< it should be seen, but nothing around it was recognised in the image
};

/// Which vertices the camera sees.
struct Visibility {
  static constexpr const char* kType = "visibility/1";
  Array<std::uint8_t> visible;  ///< [V] 0 or 1
  Array<double> score;          ///< [V] 0 hidden to 1 seen
  Array<std::uint8_t> reason;   ///< [V] SightReason
  Diagnostics diag;
  Others others = {};  ///< what else the record has

  SightReason why(std::int64_t vertex) const { return static_cast<SightReason>(reason(vertex)); }

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit(self.visible, Field{"visible", "V", "0 or 1", "1 where the camera sees the vertex"});
    visit(self.score, Field{"score", "V", "0 to 1", "0 hidden, 1 seen"});
    visit(self.reason, Field{"reason", "V", "",
                             "0 seen, 1 outside the image, 2 faces away, 3 hidden, 4 unconfirmed"});
    visit(self.diag, Field{"diag.*", "*", "", "evidence", true});
  }
};

}  // namespace weft
