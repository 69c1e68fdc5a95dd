// SPDX-License-Identifier: Apache-2.0
// Built against another version of the contract.
#include "idle.hpp"

#undef WEFT_ABI_MINOR
#define WEFT_ABI_MINOR 99

WEFT_PLUGIN(Idle, "filters/zoo_wrong_abi", "1.0.0", "Speaks another version of the contract.")
