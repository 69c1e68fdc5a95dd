// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>
#include <unistd.h>
#include <xmmintrin.h>

#include <cstdint>
#include <string>
#include <type_traits>
#include <weft/sdk/extensions.hpp>

#include "host/guarding/first_sizes.hpp"

namespace weft::host {

/// getpid() without a system call for each, also in a copy that a library made by a bare system
/// call.
pid_t process_id();

/// While a library is at work: ends a copy of the process that it makes with fork() and lets
/// return. Two processes would go on from here, answer the same call and write the same files.
class OneProcess {
 public:
  explicit OneProcess(const char* component = "a library") : component_(component) {}
  ~OneProcess() {
    if (process_id() != process_) end_copy(process_, component_);
  }
  OneProcess(const OneProcess&) = delete;
  OneProcess& operator=(const OneProcess&) = delete;

 private:
  [[noreturn]] static void end_copy(pid_t original, const char* component);

  const char* component_;
  pid_t process_ = process_id();
};

/// The component whose copy of this process was ended, or an empty text. Each is returned once;
/// of several that ended since the last call, only the last one.
std::string maker_of_ended_copy();

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

/// The status of a function of the library of `component`; WEFT_OK for a function without one. The
/// library may break its contract: an exception becomes its error, and the floating-point mode is
/// restored. `kept_mode` is false if that was necessary.
template <class Function>
std::int32_t call_library(const char* component, weft_error& error, Function&& function,
                          bool* kept_mode = nullptr) {
  const OneProcess one(component);
  const FloatingPointMode mode;
  const std::int32_t status = detail::guarded(&error, [&]() -> std::int32_t {
    if constexpr (std::is_void_v<decltype(function())>) {
      function();
      return WEFT_OK;
    } else {
      return function();
    }
  });
  const bool kept = mode.restore();
  if (kept_mode != nullptr) *kept_mode = kept;
  return status;
}

/// An extension of a component; null if it has none. Fails if the library throws, or if the table
/// is smaller than `bytes`.
Result<const void*> find_extension(const weft_component& component, const char* name,
                                   std::size_t bytes);

/// As above, with the type of the table in version 1.0.
template <class Table>
Result<const Table*> extension_of(const weft_component& component, const char* name) {
  const auto found = find_extension(component, name, kFirstSize<Table>);
  if (!found) return found.error();
  return static_cast<const Table*>(*found);
}

}  // namespace weft::host
