// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>
#include <weft/core/result.hpp>

namespace weft::conformance {

/// The entries of a library's file for the dynamic linker.
struct ElfFacts {
  std::vector<std::string> exported;  ///< symbols that it defines for others
  bool has_static_tls = false;        ///< it cannot be placed once the program runs, but for luck
};

/// Fails with io or incompatible.
Result<ElfFacts> read_elf_facts(const std::string& library);

}  // namespace weft::conformance
