// SPDX-License-Identifier: Apache-2.0
// Claims a role that there is not, past the checks of WEFT_COMPONENT.
#include "idle.hpp"

WEFT_LIBRARY(weft::detail::make_component<Idle>("filtres/test_wrong_role", "1.0.0",
                                                "Has a role that there is not."))
