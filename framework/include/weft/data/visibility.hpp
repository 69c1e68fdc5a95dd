// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/data/record.hpp>

namespace weft {

/// Reason why a vertex is classified as visible or not.
enum class SightReason : std::uint8_t {
  seen = 0,
  outside = 1,      ///< outside the image or behind the camera
  faces_away = 2,   ///< all faces around the vertex show their back
  hidden = 3,       ///< an occluder hides the vertex
  unconfirmed = 4,  ///< expected visible, but nothing around it was found in the image
};

/// Visible and hidden vertices.
struct Visibility {
  static constexpr const char* kType = "visibility/1";
  Array<std::uint8_t> visible;  ///< [V] 0 or 1
  Array<double> score;          ///< [V] 0 hidden to 1 visible
  Array<std::uint8_t> reason;   ///< [V] SightReason
  Diagnostics diag;
  Others others = {};  ///< further arrays of the record

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

/// Displacements of texture patches in the unwarped image, which is the image seen through the
/// recovered mesh.
struct Registration {
  static constexpr const char* kType = "registration/1";
  Array<double> place_px;         ///< [N,2] px of the texture, centre of each patch
  Array<double> displacement_mm;  ///< [N,2] mm along u and v of the texture; NaN if not found
  Array<double> correlation;      ///< [N] highest normalised cross-correlation, -1 to 1
  Array<std::uint8_t> found;      ///< [N] 1 where the correlation reaches the threshold
  Diagnostics diag;
  Others others = {};  ///< further arrays of the record

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
