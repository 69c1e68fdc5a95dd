// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace weft::cli {

/// To be called before anything is opened. Standard streams that the caller closed are taken up, so
/// that no file of the program gets their numbers; writing to them fails. A file beyond the size
/// limit of `ulimit -f` becomes an error of the write instead of the end of the process and of
/// those that it starts.
void guard_standard_streams();

/// True if some output could not be written; prints that error.
bool standard_output_failed();

}  // namespace weft::cli
