// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstring>

#if !defined(WEFT_MARKS_UNWRITTEN)
#if !defined(NDEBUG) || defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define WEFT_MARKS_UNWRITTEN 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define WEFT_MARKS_UNWRITTEN 1
#endif
#endif
#endif

namespace weft {

#if defined(WEFT_MARKS_UNWRITTEN)
inline constexpr bool kMarksUnwritten = true;
#else
inline constexpr bool kMarksUnwritten = false;
#endif

/// Called on memory that is handed out and that nobody has written yet. In debug builds and under a
/// sanitizer it is filled with 0xFF bytes, NaN where numbers are read out of it, so that who reads
/// what nobody wrote is found; elsewhere it keeps what stood there.
inline void mark_unwritten([[maybe_unused]] void* memory, [[maybe_unused]] std::size_t bytes) {
  if constexpr (kMarksUnwritten) {
    if (bytes > 0) std::memset(memory, 0xFF, bytes);
  }
}

}  // namespace weft
