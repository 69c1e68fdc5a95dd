// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kit/conformance/notebook.hpp"
#include "kit/conformance/play.hpp"

/// Calls with an image of 3840 x 2160 or 100,000 matches.
namespace weft::conformance {

/// Checks that a call with large inputs ends, or stops if it is cancelled after a while. `effort`
/// is a part of that time.
void check_large(const Setting& setting, double effort, Page& page);

/// Checks that it stops soon after a cancellation.
void check_cancelled(const Setting& setting, Page& page);

}  // namespace weft::conformance
