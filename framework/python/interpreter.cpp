// SPDX-License-Identifier: Apache-2.0
#include "interpreter.hpp"

#include <dlfcn.h>

#include <cstdio>
#include <mutex>

#include "host_module.hpp"

namespace weft::python {
namespace {

/// Modules in C, such as NumPy's, find the interpreter's symbols in the global scope of the
/// process. The host loads a plugin and its libraries into a local scope instead.
void show_interpreter() {
  Dl_info found{};
  if (dladdr(reinterpret_cast<void*>(&Py_IsInitialized), &found) == 0) return;
  dlopen(found.dli_fname, RTLD_NOW | RTLD_GLOBAL | RTLD_NOLOAD);
}

Result<void> failed(const PyStatus& status) {
  return Error{Errc::incompatible,
               std::string("Python does not start: ") +
                   (status.err_msg != nullptr ? status.err_msg : "for an unreported reason")};
}

Result<void> start() {
  show_interpreter();
  PyPreConfig before;
  PyPreConfig_InitPythonConfig(&before);
  before.parse_argv = 0;
  before.configure_locale = 0;
  before.coerce_c_locale = 0;
  before.coerce_c_locale_warn = 0;
  before.utf8_mode = 1;
  if (const PyStatus status = Py_PreInitialize(&before); PyStatus_Exception(status) != 0) {
    return failed(status);
  }
  PyConfig config;
  PyConfig_InitPythonConfig(&config);
  config.parse_argv = 0;
  config.install_signal_handlers = 0;
  config.write_bytecode = 0;
  config.use_hash_seed = 1;
  config.hash_seed = 0;
  config.pathconfig_warnings = 0;
  const PyStatus status = Py_InitializeFromConfig(&config);
  PyConfig_Clear(&config);
  if (PyStatus_Exception(status) != 0) return failed(status);
  PyEval_SaveThread();
  return {};
}

Ref sources_of(const Library& library) {
  Ref list(PyList_New(0));
  for (std::uint64_t i = 0; list && i < library.source_count; ++i) {
    const Source& source = library.sources[i];
    const Ref item(Py_BuildValue("(sssii)", source.name, source.file, source.text,
                                 source.is_package, source.is_own));
    if (!item || PyList_Append(list.get(), item.get()) != 0) return {};
  }
  return list;
}

/// Runs weft.loader, which is the first source.
Ref loaded(const Library& library) {
  const Ref code(Py_CompileString(library.sources[0].text, library.sources[0].file, Py_file_input));
  const Ref scope(PyDict_New()), name(PyUnicode_FromString(library.sources[0].name));
  if (!code || !scope || !name) return {};
  PyDict_SetItemString(scope.get(), "__builtins__", PyEval_GetBuiltins());
  PyDict_SetItemString(scope.get(), "__name__", name.get());
  const Ref ran(PyEval_EvalCode(code.get(), scope.get(), scope.get()));
  PyObject* load = ran ? PyDict_GetItemString(scope.get(), "load") : nullptr;
  const Ref host(make_host_module()), sources = sources_of(library);
  if (load == nullptr || !host || !sources) return {};
  return Ref(PyObject_CallFunctionObjArgs(load, sources.get(), host.get(), nullptr));
}

}  // namespace

Result<void> start_interpreter() {
  // A lock of the process that each library has, as there is none of the interpreter before it
  // runs.
  flockfile(stdin);
  Result<void> started = Py_IsInitialized() != 0 ? Result<void>{} : start();
  funlockfile(stdin);
  return started;
}

Result<PyObject*> bridge_of(const Library& library) {
  static std::mutex mutex;
  static PyObject* bridge = nullptr;  // lives as long as the process
  if (auto started = start_interpreter(); !started) return started.error();
  const std::lock_guard lock(mutex);
  if (bridge != nullptr) return bridge;
  const Gil gil;
  bridge = loaded(library).release();
  if (bridge != nullptr) return bridge;
  return Error{Errc::incompatible, "its modules cannot be imported: " + raised()};
}

}  // namespace weft::python
