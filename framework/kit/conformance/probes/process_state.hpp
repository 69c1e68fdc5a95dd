// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

/// What a library shares with the process that loads it.
namespace weft::conformance {

std::size_t count_descriptors();
std::size_t count_threads();
std::int64_t resident_bytes();  ///< of the process; under a sanitizer, those of the heap
std::int64_t heap_bytes();      ///< that are allocated and not freed

/// [ms] of processor time that this process took so far, all of its threads.
double processor_ms();

/// [ms] for which a thread could have computed and had no processor; 0 where the kernel does not
/// say.
double queued_ms(int thread);

/// How this thread rounds, and whether it takes subnormal numbers for zero, as text.
std::string floating_point_mode();

/// What nobody but the program itself changes, by name, as text: "locale", "signals",
/// "working_directory", "umask", "environment".
std::map<std::string, std::string> process_state();

/// How many threads OpenCV would use; -1 where it is not loaded.
int opencv_threads();

/// Looks for opened files: from now on none of this process can be opened, and the first that
/// should have been is kept. False where the kernel cannot do that. There is no way back.
bool forbid_opening();
/// Its path; empty for none.
std::string forbidden_opening();

}  // namespace weft::conformance
