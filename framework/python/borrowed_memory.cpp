// SPDX-License-Identifier: Apache-2.0
#include "borrowed_memory.hpp"

#include <iterator>

namespace weft::python {
namespace {

struct Element {
  const char* format;
  Py_ssize_t bytes;
};

/// Indexed by weft_dtype.
constexpr Element kElements[] = {{nullptr, 0}, {"B", 1}, {"b", 1}, {"H", 2}, {"h", 2}, {"i", 4},
                                 {"l", 8},     {"f", 4}, {"d", 8}, {"e", 2}, {"I", 4}, {"L", 8}};

int refuse(Py_buffer* view, const char* why) {
  view->obj = nullptr;
  PyErr_SetString(PyExc_BufferError, why);
  return -1;
}

int get_buffer(PyObject* self, Py_buffer* view, int flags) {
  BorrowedMemory& memory = memory_in(self);
  const bool strided = (flags & PyBUF_STRIDES) == PyBUF_STRIDES;
  const bool asks_rows = (flags & PyBUF_C_CONTIGUOUS) == PyBUF_C_CONTIGUOUS ||
                         (flags & PyBUF_ANY_CONTIGUOUS) == PyBUF_ANY_CONTIGUOUS;
  const bool asks_columns = (flags & PyBUF_F_CONTIGUOUS) == PyBUF_F_CONTIGUOUS;
  if (memory.is_over) return refuse(view, "the call that lent this array is over; keep a copy");
  if (!memory.is_writable && (flags & PyBUF_WRITABLE) == PyBUF_WRITABLE) {
    return refuse(view, "inputs are read-only");
  }
  if (!memory.is_contiguous && (!strided || asks_rows)) {
    return refuse(view, "the rows of this array are padded");
  }
  if (asks_columns && memory.ndim > 1) return refuse(view, "this array goes row by row");
  view->buf = memory.data;
  view->len = memory.bytes;
  view->itemsize = memory.item_bytes;
  view->readonly = memory.is_writable ? 0 : 1;
  view->ndim = memory.ndim;
  view->format = (flags & PyBUF_FORMAT) != 0 ? const_cast<char*>(memory.format) : nullptr;
  view->shape = (flags & PyBUF_ND) != 0 ? memory.shape : nullptr;
  view->strides = strided ? memory.stride : nullptr;
  view->suboffsets = nullptr;
  view->internal = nullptr;
  Py_INCREF(self);
  view->obj = self;
  ++memory.views;
  return 0;
}

void release_buffer(PyObject* self, Py_buffer*) { --memory_in(self).views; }

void deallocate(PyObject* self) {
  PyTypeObject* type = Py_TYPE(self);
  type->tp_free(self);
  Py_DECREF(reinterpret_cast<PyObject*>(type));
}

/// Made once, with the lock of the interpreter.
PyTypeObject* type_of_memory() {
  static PyTypeObject* type = nullptr;
  if (type != nullptr) return type;
  PyType_Slot slots[] = {{Py_bf_getbuffer, reinterpret_cast<void*>(&get_buffer)},
                         {Py_bf_releasebuffer, reinterpret_cast<void*>(&release_buffer)},
                         {Py_tp_dealloc, reinterpret_cast<void*>(&deallocate)},
                         {0, nullptr}};
  PyType_Spec spec = {"weft.host.Memory", sizeof(BorrowedMemory), 0,
                      Py_TPFLAGS_DEFAULT | Py_TPFLAGS_DISALLOW_INSTANTIATION, slots};
  type = reinterpret_cast<PyTypeObject*>(PyType_FromSpec(&spec));
  return type;
}

}  // namespace

Ref lend(const char* slot, const char* name, void* data, std::int32_t dtype, std::int32_t ndim,
         const std::int64_t* shape, const std::int64_t* stride, bool is_writable) {
  if (dtype < 1 || dtype >= static_cast<std::int32_t>(std::size(kElements)) || ndim < 0 ||
      ndim > WEFT_MAX_DIMENSIONS) {
    PyErr_SetString(PyExc_TypeError, "an array has an unknown type or too many axes");
    return {};
  }
  PyTypeObject* type = type_of_memory();
  Ref object(type != nullptr ? type->tp_alloc(type, 0) : nullptr);
  if (!object) return {};
  static char nothing = 0;  // arrays without elements need a place, too
  const Element& element = kElements[dtype];
  BorrowedMemory& memory = memory_in(object.get());
  memory.data = data != nullptr ? data : &nothing;
  memory.slot = slot;
  memory.name = name;
  memory.format = element.format;
  memory.item_bytes = memory.bytes = element.bytes;
  memory.ndim = ndim;
  memory.is_writable = is_writable;
  memory.is_contiguous = true;
  for (int axis = ndim - 1; axis >= 0; --axis) {
    memory.shape[axis] = static_cast<Py_ssize_t>(shape[axis]);
    const Py_ssize_t dense = memory.bytes;
    memory.stride[axis] = stride != nullptr ? static_cast<Py_ssize_t>(stride[axis]) : dense;
    if (memory.stride[axis] != dense && memory.shape[axis] > 1) memory.is_contiguous = false;
    memory.bytes *= memory.shape[axis];
  }
  return object;
}

}  // namespace weft::python
