// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

namespace weft::host {

struct MissingSanitizer {
  std::string cause;  ///< behind "it"
  std::string fix;
};

/// Of a library that was built with a sanitizer whose runtime is not in this process, and cannot
/// come with the library: the runtime ends the process, or its symbols are missing. The file is
/// read, not loaded; nothing of one that cannot be read.
std::optional<MissingSanitizer> missing_sanitizer(const std::string& library);

}  // namespace weft::host
