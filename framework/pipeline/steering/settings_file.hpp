// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <weft/core/result.hpp>

namespace weft {

/// Writes a pipeline file settings-N.yaml into the folder of a run and gives N, the first number
/// from 1 whose file does not exist. The file appears with all of its text. The Error explains why
/// it is not there: the folder is gone, may not be written, or is full.
Result<std::uint64_t> save_settings(const std::string& folder, const std::string& text);

}  // namespace weft
