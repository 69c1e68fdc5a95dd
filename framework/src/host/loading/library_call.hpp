// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/sdk/extensions.hpp>

#include "host/loading/floating_point.hpp"

namespace weft::host {

/// The status of a function of a library, which is not trusted to keep its promises: an exception
/// is its error, and the floating-point mode is set back. `kept_mode` says whether that was needed.
template <class Function>
std::int32_t call_library(weft_error& error, Function&& function, bool* kept_mode = nullptr) {
  const FloatingPointMode mode;
  const std::int32_t status = detail::guarded(&error, function);
  const bool kept = mode.restore();
  if (kept_mode != nullptr) *kept_mode = kept;
  return status;
}

}  // namespace weft::host
