// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "call_scope.hpp"

namespace weft::python {

/// A new object with the methods of the scope; null, with an exception, where memory is short.
PyObject* make_call_object(CallScope& scope);

/// The scope is over: methods raise from now on.
void end_call_object(PyObject* object);

}  // namespace weft::python
