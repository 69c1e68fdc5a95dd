// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace weft {

/// Extension of components that had better not share the process of a run, as those that bring an
/// interpreter: their stage has a process of its own unless the pipeline says `isolate: none`. It
/// is read when the library is described and never asked for in a run.
inline constexpr const char* kPrefersIsolation = "weft.draft.isolation/1";
struct PrefersIsolation {
  std::uint32_t struct_size;
  std::uint32_t reserved;
};

}  // namespace weft
