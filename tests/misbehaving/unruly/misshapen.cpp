// SPDX-License-Identifier: Apache-2.0
// Libraries whose symbol differs from the one that a host expects, as SHAPE specifies.
#include <cstdint>

extern "C" {
#define EXPORTED __attribute__((visibility("default")))
#if defined(SHAPE_FUNCTION)
EXPORTED int weft_library() { return 42; }
#elif defined(SHAPE_SMALL)
EXPORTED extern const std::uint32_t weft_library[3];
const std::uint32_t weft_library[3] = {0x54464557U, 1U, 96U};
#elif defined(SHAPE_ZEROED) || defined(SHAPE_ANONYMOUS)
EXPORTED std::uint64_t weft_library[16];
#elif defined(SHAPE_UNRESOLVED)
int nowhere_to_be_found();
EXPORTED extern const std::uint64_t weft_library[16];
const std::uint64_t weft_library[16] = {1};
EXPORTED int calls_it();
int calls_it() { return nowhere_to_be_found(); }
#endif
}
