// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/abi.h>

#include "python_objects.hpp"

namespace weft::python {

/// Memory of the host that a call lends to Python, as an object with a buffer: arrays over it are
/// views, and it counts them.
struct BorrowedMemory {
  PyObject ob_base;
  void* data;
  const char *slot, *name;  ///< name of the array; valid until the call returns
  const char* format;       ///< as of Python's module struct
  Py_ssize_t item_bytes, bytes, views;
  int ndim;  ///< [] number of axes
  bool is_writable, is_contiguous, is_over;
  Py_ssize_t shape[WEFT_MAX_DIMENSIONS], stride[WEFT_MAX_DIMENSIONS];
};

/// Null, with an exception, where memory is short or the element type unknown. Without `stride`
/// [bytes] the array is contiguous.
Ref lend(const char* slot, const char* name, void* data, std::int32_t dtype, std::int32_t ndim,
         const std::int64_t* shape, const std::int64_t* stride, bool is_writable);

inline BorrowedMemory& memory_in(PyObject* object) {
  return *reinterpret_cast<BorrowedMemory*>(object);
}

}  // namespace weft::python
