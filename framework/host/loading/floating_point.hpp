// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <xmmintrin.h>

#include <cfenv>

namespace weft::host {

/// How this thread rounds, and whether it takes tiny numbers for zero, as it was when this object
/// was made. A library that leaves it changed, as one built with -ffast-math does when it is
/// loaded, would change what all others compute.
class FloatingPointMode {
 public:
  /// Sets the mode back; false where it was another one.
  bool restore() const {
    if (std::fegetround() == rounding_ && control() == control_) return true;
    std::fesetround(rounding_);
    _mm_setcsr(control_ | (_mm_getcsr() & kFlags));
    return false;
  }

 private:
  static constexpr unsigned kFlags =
      0x3F;  ///< exception flags so far; the other bits are control bits
  static unsigned control() { return _mm_getcsr() & ~kFlags; }

  int rounding_ = std::fegetround();
  unsigned control_ = control();
};

}  // namespace weft::host
