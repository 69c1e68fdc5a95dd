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

/// How far patches of the template's texture are from their places in the unwarped image, which is
/// the image seen through the recovered mesh.
struct Registration {
  static constexpr const char* kType = "registration/1";
  Array<double> place_px;         ///< [N,2] px of the texture, centre of each patch
  Array<double> displacement_mm;  ///< [N,2] mm along u and v of the texture, NaN where not found
  Array<double> correlation;      ///< [N] highest normalised cross-correlation, -1 to 1
  Array<std::uint8_t> found;      ///< [N] 1 where the correlation reaches the threshold
  Diagnostics diag;
  Others others = {};  ///< what else the record has

  std::int64_t count() const { return found.rows(); }

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit(self.place_px, Field{"place_px", "N,2", "px of the texture", "centre of each patch"});
    visit(self.displacement_mm,
          Field{"displacement_mm", "N,2", "mm",
                "from there to where the unwarped image shows the patch, along u and v of the "
                "texture",
                false, true});
    visit(self.correlation, Field{"correlation", "N", "-1 to 1",
                                  "highest normalised cross-correlation in the search range"});
    visit(self.found,
          Field{"found", "N", "0 or 1", "1 where the correlation reaches the threshold"});
    visit(self.diag, Field{"diag.*", "*", "", "evidence", true});
  }
};

}  // namespace weft
