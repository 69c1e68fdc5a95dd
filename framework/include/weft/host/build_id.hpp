// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <weft/core/result.hpp>

namespace weft::host {

/// The GNU build-id of an ELF file in hexadecimal, read from its notes without loading it. It
/// survives install and strip, which change the file. Empty when the file has none.
Result<std::string> read_build_id(const std::string& file);

}  // namespace weft::host
