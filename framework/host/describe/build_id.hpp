// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <weft/core/result.hpp>

#include "host/describe/elf_file.hpp"

namespace weft::host {

/// The GNU build-id of an ELF file in hexadecimal, read from its notes without
/// loading it. It survives install and strip, which change the file. Empty when
/// the file has none.
Result<std::string> read_build_id(const std::string& path);
std::string build_id_of(const ElfFile& file);

/// Checks that a library can be mapped: a regular file that has all bytes to
/// which its headers and its dynamic section refer. Each library passes this
/// check before it is loaded, because a process that maps a truncated file dies
/// of SIGBUS. Fails with io or incompatible.
Result<void> check_library_file(const std::string& path);

}  // namespace weft::host
