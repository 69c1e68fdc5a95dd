// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <weft/core/result.hpp>

namespace weft::host {

/// The GNU build-id of an ELF file in hexadecimal, read from its notes without loading it. It
/// survives install and strip, which change the file. Empty when the file has none.
Result<std::string> read_build_id(const std::string& path);

/// Whether a library can be mapped: a regular file that has all bytes that its headers and its
/// dynamic section name. Each library passes this before it is loaded, for a process that maps a
/// file which is cut off dies of SIGBUS. Fails with io or incompatible.
Result<void> check_library_file(const std::string& path);

}  // namespace weft::host
