// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <xmmintrin.h>

#include <cstdint>

namespace weft::host {

/// How this thread rounds, with which precision, and whether it takes tiny numbers for zero, as it
/// was when this object was made. A library that leaves it changed, as one built with -ffast-math
/// does when it is loaded, would change what all others compute.
class FloatingPointMode {
 public:
  /// Sets the mode back; false where it was another one.
  bool restore() const {
    if (of_x87() == x87_ && of_sse() == sse_) return true;
    __asm__ volatile("fldcw %0" : : "m"(x87_));
    _mm_setcsr(sse_ | (_mm_getcsr() & kFlags));
    return false;
  }

 private:
  static constexpr unsigned kFlags =
      0x3F;  ///< exception flags so far; the other bits are control bits
  static unsigned of_sse() { return _mm_getcsr() & ~kFlags; }
  static std::uint16_t of_x87() {
    std::uint16_t word = 0;
    __asm__ volatile("fnstcw %0" : "=m"(word));
    return word;
  }

  std::uint16_t x87_ = of_x87();
  unsigned sse_ = of_sse();
};

}  // namespace weft::host
