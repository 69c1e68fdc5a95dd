// SPDX-License-Identifier: Apache-2.0
// Built for a processor that does not exist.
#include "idle.hpp"

#undef WEFT_ISA
#define WEFT_ISA "sse4.2 amx_fake "

WEFT_PLUGIN(Idle, "filters/test_wrong_isa", "1.0.0", "Needs another processor.")
