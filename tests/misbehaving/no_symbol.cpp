// SPDX-License-Identifier: Apache-2.0
// Hides its library table from the outside, as a build without weft_add_plugin() might.
#define WEFT_EXPORT __attribute__((visibility("hidden")))
#include "idle.hpp"

namespace {
constexpr weft_component kComponent =
    WEFT_COMPONENT(Idle, "filters/test_no_symbol", "1.0.0", "Hides its table.");
constexpr const weft_component* kPointer = &kComponent;
}  // namespace

// As if WEFT_EXPORT had been lost on the way.
const weft_library_table weft_library = {WEFT_ABI_MAGIC,
                                         WEFT_ABI_MAJOR,
                                         WEFT_ABI_MINOR,
                                         sizeof(weft_library_table),
                                         1,
                                         WEFT_ABI_NAME,
                                         &kPointer,
                                         WEFT_ISA,
                                         WEFT_COMPILER,
                                         0,
                                         0,
                                         0,
                                         {0, 0, 0, 0}};
