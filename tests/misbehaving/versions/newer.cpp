// SPDX-License-Identifier: Apache-2.0
// Built against a later minor version of the contract, with longer structs that use reserved
// members. It needs none of these, so that this host can run it.
#include <array>

#include "../idle.hpp"

namespace {

struct LaterComponent {
  weft_component known;
  const char* unknown;
};
struct LaterTable {
  weft_library_table known;
  std::array<std::uint64_t, 4> unknown;
};

constexpr LaterComponent kComponent = [] {
  LaterComponent later{
      WEFT_COMPONENT(Idle, "filters/test_newer", "1.0.0", "Comes from a later version."), "?"};
  later.known.struct_size = sizeof(later);
  later.known.flags |= 1U << 15U;
  return later;
}();
constexpr const weft_component* kPointer = &kComponent.known;

}  // namespace

// Under another name in C++, where the symbol is declared with the length of today.
extern "C" WEFT_EXPORT const LaterTable later_table __asm__("weft_library");
const LaterTable later_table = {{WEFT_ABI_MAGIC,
                                 WEFT_ABI_MAJOR,
                                 99,
                                 sizeof(LaterTable),
                                 1,
                                 WEFT_ABI_NAME,
                                 &kPointer,
                                 WEFT_ISA,
                                 WEFT_COMPILER,
                                 0,
                                 7,
                                 1U << 15U,
                                 {1, 2, 3, 4}},
                                {5, 6, 7, 8}};
