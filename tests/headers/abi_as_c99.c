// SPDX-License-Identifier: Apache-2.0
#include <weft/abi.h>
#include <weft/budget.h>
