// SPDX-License-Identifier: Apache-2.0
#include "call_object.hpp"

#include <structmember.h>

#include <cstddef>
#include <exception>
#include <new>

namespace weft::python {
namespace {

/// The Python object of a call, wrapped by weft.given.Call.
struct CallObject {
  PyObject ob_base;
  CallScope* scope;  ///< null when the call is over
  unsigned long long frame, seed;
  int threads;
};

CallObject& call_in(PyObject* object) { return *reinterpret_cast<CallObject*>(object); }

/// Runs `body(scope)`; no exception of C++ goes through the interpreter.
template <class Body>
PyObject* in_scope(PyObject* self, Body&& body) {
  CallScope* scope = call_in(self).scope;
  if (scope == nullptr) {
    PyErr_SetString(PyExc_RuntimeError, "the call is over; keep neither it nor what it gave");
    return nullptr;
  }
  try {
    return body(*scope);
  } catch (const std::bad_alloc&) {
    return PyErr_NoMemory();
  } catch (const std::exception& thrown) {
    PyErr_SetString(PyExc_RuntimeError, thrown.what());
    return nullptr;
  }
}

PyObject* alloc(PyObject* self, PyObject* arguments) {
  return in_scope(self, [&](CallScope& scope) { return scope.alloc(arguments); });
}
PyObject* invoke(PyObject* self, PyObject* arguments) {
  return in_scope(self, [&](CallScope& scope) { return scope.invoke(arguments); });
}
PyObject* cancelled(PyObject* self, PyObject*) {
  return in_scope(self, [](CallScope& scope) {
    return PyBool_FromLong(scope.call().host->cancelled(&scope.call()));
  });
}
PyObject* log(PyObject* self, PyObject* arguments) {
  return in_scope(self, [&](CallScope& scope) -> PyObject* {
    int level = 0;
    const char* text = nullptr;
    if (PyArg_ParseTuple(arguments, "is", &level, &text) == 0) return nullptr;
    scope.call().host->log(&scope.call(), level, text);
    Py_RETURN_NONE;
  });
}

void end(PyObject* self) {
  PyTypeObject* type = Py_TYPE(self);
  type->tp_free(self);
  Py_DECREF(reinterpret_cast<PyObject*>(type));
}

/// Made once, with the lock of the interpreter.
PyTypeObject* type_of_calls() {
  static PyTypeObject* type = nullptr;
  if (type != nullptr) return type;
  static PyMethodDef methods[] = {{"alloc", &alloc, METH_VARARGS, nullptr},
                                  {"cancelled", &cancelled, METH_NOARGS, nullptr},
                                  {"invoke", &invoke, METH_VARARGS, nullptr},
                                  {"log", &log, METH_VARARGS, nullptr},
                                  {nullptr, nullptr, 0, nullptr}};
  static PyMemberDef members[] = {
      {"frame", T_ULONGLONG, offsetof(CallObject, frame), READONLY, nullptr},
      {"seed", T_ULONGLONG, offsetof(CallObject, seed), READONLY, nullptr},
      {"threads", T_INT, offsetof(CallObject, threads), READONLY, nullptr},
      {nullptr, 0, 0, 0, nullptr}};
  PyType_Slot slots[] = {{Py_tp_methods, methods},
                         {Py_tp_members, members},
                         {Py_tp_dealloc, reinterpret_cast<void*>(&end)},
                         {0, nullptr}};
  PyType_Spec spec = {"weft.host.Call", sizeof(CallObject), 0,
                      Py_TPFLAGS_DEFAULT | Py_TPFLAGS_DISALLOW_INSTANTIATION, slots};
  type = reinterpret_cast<PyTypeObject*>(PyType_FromSpec(&spec));
  return type;
}

}  // namespace

PyObject* make_call_object(CallScope& scope) {
  PyTypeObject* type = type_of_calls();
  PyObject* object = type != nullptr ? type->tp_alloc(type, 0) : nullptr;
  if (object == nullptr) return nullptr;
  CallObject& call = call_in(object);
  call.scope = &scope;
  call.frame = scope.call().frame;
  call.seed = scope.call().seed;
  call.threads = scope.call().threads;
  return object;
}

void end_call_object(PyObject* object) { call_in(object).scope = nullptr; }

}  // namespace weft::python
