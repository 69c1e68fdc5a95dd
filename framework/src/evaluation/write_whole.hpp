// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <weft/core/result.hpp>

namespace weft::evaluation {

/// Writes a file that appears whole: it is renamed from a temporary name beside it. A device, such
/// as /dev/stdout, is written directly.
Result<void> write_whole(const std::string& text, const std::string& file);

}  // namespace weft::evaluation
