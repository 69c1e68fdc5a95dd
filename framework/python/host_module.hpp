// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "python_objects.hpp"

namespace weft::python {

/// The module weft.host: `catalogue()` and `roles()`, of the declarations in C++. Null with an
/// exception.
PyObject* make_host_module();

}  // namespace weft::python
