// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "host/describe/elf_file.hpp"

namespace weft::host {

struct MissingSanitizer {
  std::string cause;  ///< behind "it"
  std::string fix;
};

/// The missing runtime of a library that was built with a sanitizer, if this
/// process lacks that runtime. It cannot be loaded with the library: it would
/// end the process, or its symbols are missing. The file is read, not loaded;
/// the result is empty if it is unreadable.
std::optional<MissingSanitizer> missing_sanitizer(const std::string& library);
std::optional<MissingSanitizer> missing_sanitizer(const ElfFile& library);

}  // namespace weft::host
