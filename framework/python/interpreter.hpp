// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/core/result.hpp>

#include "python_library.hpp"
#include "python_objects.hpp"

namespace weft::python {

/// Starts the interpreter of this process, unless it runs: by whichever library comes first. It
/// leaves locale, signals and working directory alone, and its hashes are the same in each process.
Result<void> start_interpreter();

/// The module weft.bridge of the library, borrowed. The first call imports it with the author's
/// modules. Call it without the lock of the interpreter.
Result<PyObject*> bridge_of(const Library& library);

}  // namespace weft::python
