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

/// Marks memory that is handed out before it is written. Debug builds and sanitizer builds fill it
/// with 0xFF bytes (NaN for floating-point numbers) to reveal reads of unwritten memory. Other
/// builds leave it unchanged.
inline void mark_unwritten([[maybe_unused]] void* memory, [[maybe_unused]] std::size_t bytes) {
  if constexpr (kMarksUnwritten) {
    if (bytes > 0) std::memset(memory, 0xFF, bytes);
  }
}

}  // namespace weft
