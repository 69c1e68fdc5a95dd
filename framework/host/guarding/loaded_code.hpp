// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace weft::host {

/// Notes where the code of a library lies that has this symbol and is never unloaded, for
/// library_that_runs(). At most 512 libraries are noted.
void note_code_of(const void* symbol, const std::string& file);

/// The file name of the noted library whose code a thread runs, or null. It has the instruction, or
/// else the innermost return address in the 64 KiB from the top of the stack. Signal handlers can
/// call this.
const char* library_that_runs(std::uintptr_t instruction, std::uintptr_t stack_top);

}  // namespace weft::host
