// SPDX-License-Identifier: Apache-2.0
// Claims a role that there is not.
#include "idle.hpp"

WEFT_PLUGIN(Idle, "filtres/zoo_wrong_role", "1.0.0", "Has a role that there is not.")
