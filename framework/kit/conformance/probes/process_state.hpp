// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

/// The state that a library shares with the process that loads it.
namespace weft::conformance {

std::size_t count_descriptors();
std::size_t count_threads();
std::int64_t resident_bytes();  ///< memory of the process; under a sanitizer, that of the heap
std::int64_t heap_bytes();      ///< that are allocated and not freed

/// [bytes] printed to stdout so far, where that is a file.
std::int64_t printed_bytes();

/// [ms] of CPU time that this process has used so far, in all of its threads.
double processor_ms();

/// [ms] for which a thread was ready but had no processor; 0 if the kernel does not report it.
double queued_ms(int thread);

/// How this thread rounds, and whether it takes subnormal numbers for zero, as text.
std::string floating_point_mode();

/// The state that only the program itself may change, by name, as text: "locale", "floating_point",
/// "signals", "working_directory", "umask", "environment", "process".
std::map<std::string, std::string> process_state();

/// How many threads OpenCV would use; -1 where it is not loaded.
int opencv_threads();

/// Looks for opened files: from now on none of this process can be opened, and the first that
/// should have been is kept. False where the kernel cannot do that. There is no way back.
bool forbid_opening();
/// Its path; empty for none.
std::string forbidden_opening();

}  // namespace weft::conformance
