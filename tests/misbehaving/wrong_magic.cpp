// SPDX-License-Identifier: Apache-2.0
// Its symbol has the right name and is something else.
#include "idle.hpp"

#undef WEFT_ABI_MAGIC
#define WEFT_ABI_MAGIC 0x12345678u

WEFT_PLUGIN(Idle, "filters/test_wrong_magic", "1.0.0", "Is no Weft library.")
