// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kit/conformance/notebook.hpp"
#include "kit/conformance/play.hpp"

/// Calls with an image of 3840 x 2160 or 100,000 matches.
namespace weft::conformance {

/// It comes to an end, or stops when it is told to after a while.
void check_large(const Setting& setting, Page& page);

/// It stops soon after it was told to.
void check_cancelled(const Setting& setting, Page& page);

}  // namespace weft::conformance
