// SPDX-License-Identifier: Apache-2.0
// Cannot do without what a later version of the contract has.
#define WEFT_NEEDS_MINOR 99
#include "../idle.hpp"

WEFT_PLUGIN(Idle, "filters/test_wrong_abi", "1.0.0", "Needs a later version of the contract.")
