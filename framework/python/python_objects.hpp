// SPDX-License-Identifier: Apache-2.0
#pragma once

#define PY_SSIZE_T_CLEAN
#include <Python.h>

#include <string>
#include <utility>

namespace weft::python {

/// Holds the lock of the interpreter, on any thread.
class Gil {
 public:
  Gil() : state_(PyGILState_Ensure()) {}
  ~Gil() { PyGILState_Release(state_); }
  Gil(const Gil&) = delete;
  Gil& operator=(const Gil&) = delete;

 private:
  PyGILState_STATE state_;
};

/// Lets others have the lock, for as long as it lives.
class WithoutGil {
 public:
  WithoutGil() : state_(PyEval_SaveThread()) {}
  ~WithoutGil() { PyEval_RestoreThread(state_); }
  WithoutGil(const WithoutGil&) = delete;
  WithoutGil& operator=(const WithoutGil&) = delete;

 private:
  PyThreadState* state_;
};

/// A reference to an object; null for none.
class Ref {
 public:
  Ref() = default;
  explicit Ref(PyObject* owned) : object_(owned) {}
  ~Ref() { Py_XDECREF(object_); }
  Ref(Ref&& other) noexcept : object_(std::exchange(other.object_, nullptr)) {}
  Ref& operator=(Ref&& other) noexcept {
    std::swap(object_, other.object_);
    return *this;
  }
  Ref(const Ref&) = delete;
  Ref& operator=(const Ref&) = delete;

  /// Another reference to a borrowed object.
  static Ref to(PyObject* borrowed) {
    Py_XINCREF(borrowed);
    return Ref(borrowed);
  }

  PyObject* get() const { return object_; }
  PyObject* release() { return std::exchange(object_, nullptr); }
  explicit operator bool() const { return object_ != nullptr; }

 private:
  PyObject* object_ = nullptr;
};

/// "ValueError: sentence": what was raised, which is then forgotten.
inline std::string raised() {
  PyObject *type = nullptr, *value = nullptr, *trace = nullptr;
  PyErr_Fetch(&type, &value, &trace);
  PyErr_NormalizeException(&type, &value, &trace);
  const Ref type_ref(type), value_ref(value), trace_ref(trace);
  if (type == nullptr) return "nothing was raised";
  const Ref name(PyObject_GetAttrString(type, "__name__"));
  const Ref sentence(value != nullptr ? PyObject_Str(value) : nullptr);
  const char* name_text = name ? PyUnicode_AsUTF8(name.get()) : nullptr;
  const char* text = sentence ? PyUnicode_AsUTF8(sentence.get()) : nullptr;
  std::string result = name_text != nullptr ? name_text : "an exception";
  if (text != nullptr) result += std::string(": ") + text;
  PyErr_Clear();
  return result;
}

}  // namespace weft::python
