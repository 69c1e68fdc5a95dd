// SPDX-License-Identifier: Apache-2.0
#include "python_library.hpp"

#include <algorithm>
#include <cstring>
#include <memory>
#include <string>
#include <string_view>
#include <weft/sdk/extensions.hpp>
#include <weft/sdk/roles.hpp>

#include "call_scope.hpp"
#include "interpreter.hpp"

namespace weft::python {
namespace {

/// A component that was created.
struct Instance {
  PyObject* bridge;  ///< borrowed, lives as long as the process
  Ref component;
};

/// The answer of weft.bridge.
struct BridgeAnswer {
  std::int32_t status;
  Error error;  ///< for degenerate its message is the reason
  Ref value;
};

BridgeAnswer answer_of(const Ref& answer) {
  int status = WEFT_ERROR, code = 0;
  const char* message = nullptr;
  PyObject* value = nullptr;
  if (!answer || PyArg_ParseTuple(answer.get(), "iisO", &status, &code, &message, &value) == 0) {
    return {WEFT_ERROR, {Errc::plugin_failure, "threw: " + raised()}, {}};
  }
  return {status, {static_cast<Errc>(code), message}, Ref::to(value)};
}

std::int32_t say(const BridgeAnswer& answer, weft_error* error) {
  if (answer.status == WEFT_OK) return WEFT_OK;
  report(answer.error, error);
  return answer.status;
}

/// One value of a vector, or the only one.
Ref element_of(const weft_value& value, std::uint64_t index) {
  switch (value.type) {
    case WEFT_VALUE_F64:
      return Ref(PyFloat_FromDouble(static_cast<const double*>(value.data)[index]));
    case WEFT_VALUE_I64:
      return Ref(PyLong_FromLongLong(static_cast<const std::int64_t*>(value.data)[index]));
    case WEFT_VALUE_BOOL:
      return Ref(PyBool_FromLong(static_cast<const std::uint8_t*>(value.data)[index]));
    case WEFT_VALUE_COMPONENT:
      return Ref(PyLong_FromUnsignedLongLong(static_cast<const std::uint64_t*>(value.data)[index]));
    default:
      return Ref(PyUnicode_FromString(static_cast<const char* const*>(value.data)[index]));
  }
}

Ref labels_in(const weft_value& value) {
  Ref dict(PyDict_New());
  for (std::uint64_t i = 0; i + 1 < value.count; i += 2) {
    const Ref key = element_of(value, i), text = element_of(value, i + 1);
    if (!dict || !key || !text || PyDict_SetItem(dict.get(), key.get(), text.get()) != 0) return {};
  }
  return dict;
}

Ref python_value(const weft_value& value) {
  if (value.type == WEFT_VALUE_LABELS) return labels_in(value);
  if (value.is_vector == 0) return element_of(value, 0);
  Ref list(PyList_New(0));
  for (std::uint64_t i = 0; i < value.count; ++i) {
    const Ref item = element_of(value, i);
    if (!list || !item || PyList_Append(list.get(), item.get()) != 0) return {};
  }
  return list;
}

Ref python_values(const weft_value* values, std::uint64_t count) {
  Ref dict(PyDict_New());
  for (std::uint64_t i = 0; i < count; ++i) {
    const Ref value = python_value(values[i]);
    if (!dict || !value || PyDict_SetItemString(dict.get(), values[i].name, value.get()) != 0) {
      return {};
    }
  }
  return dict;
}

/// The error of a number or a word, for the author of the parameter's declaration; or empty.
std::string illegal_value(const weft_value& value, const weft_parameter& declared) {
  if (value.type != declared.default_value.type ||
      value.is_vector != declared.default_value.is_vector) {
    return "has another type than it was declared with";
  }
  for (std::uint64_t i = 0; i < value.count; ++i) {
    bool is_legal = true;
    if (value.type == WEFT_VALUE_F64) {
      const double number = static_cast<const double*>(value.data)[i];
      is_legal = number >= declared.minimum && number <= declared.maximum;
    } else if (value.type == WEFT_VALUE_I64) {
      const std::int64_t number = static_cast<const std::int64_t*>(value.data)[i];
      is_legal = number >= declared.integer_minimum && number <= declared.integer_maximum;
    } else if (value.type == WEFT_VALUE_CHOICE) {
      const std::string_view word = static_cast<const char* const*>(value.data)[i];
      const auto* end = declared.choices + declared.choice_count;
      is_legal = std::find(declared.choices, end, word) != end;
    }
    if (!is_legal) return "is outside its range, or none of its choices";
  }
  return {};
}

/// Calls a function of weft.bridge for a component, with a call and its inputs.
template <class Ask>
std::int32_t call_bridge(const weft_call& call, const weft_record* inputs, std::uint64_t count,
                         weft_error* error, Ask&& ask) {
  const Gil gil;
  CallScope scope(call, inputs, count);
  BridgeAnswer answer{WEFT_ERROR, {}, {}};
  {
    const Ref records = scope.inputs();
    answer = answer_of(records && scope.object() != nullptr ? ask(scope.object(), records.get())
                                                            : Ref());
  }
  answer.value = {};
  const std::string kept = scope.take_back();
  const bool usable = answer.status == WEFT_OK || answer.status == WEFT_DEGENERATE;
  if (kept.empty() || !usable) return say(answer, error);
  return report({Errc::plugin_failure, "keeps a view of " + kept +
                                           " beyond the call, where it is not valid; keep a copy"},
                error);
}

std::int32_t check(void* self, void* context, Mistakes::Report mistake, weft_error* error) {
  return detail::guarded(error, [&]() -> std::int32_t {
    const Gil gil;
    const Instance& instance = *static_cast<Instance*>(self);
    const BridgeAnswer answer = answer_of(
        Ref(PyObject_CallMethod(instance.bridge, "check", "O", instance.component.get())));
    if (answer.status != WEFT_OK) return say(answer, error);
    for (Py_ssize_t i = 0; i < PyList_Size(answer.value.get()); ++i) {
      const char *parameter = nullptr, *message = nullptr;
      if (PyArg_ParseTuple(PyList_GetItem(answer.value.get(), i), "ss", &parameter, &message) ==
          0) {
        return report({Errc::plugin_failure, "threw: " + raised()}, error);
      }
      mistake(context, parameter, message);
    }
    return WEFT_OK;
  });
}

constexpr weft_check kCheck{sizeof(weft_check), 0, &check};
constexpr weft_isolation kOwnProcess{sizeof(weft_isolation), 0};

}  // namespace

std::int32_t describe(const Declaration& declaration, const weft_describe& sink) {
  for (std::uint64_t i = 0; i < declaration.parameter_count; ++i) {
    sink.parameter(sink.context, &declaration.parameters[i]);
  }
  for (const Role& role : all_roles()) {
    if (role.name != declaration.role) continue;
    for (const RoleMethod& method : role.methods) {
      for (const auto* slots : {&method.inputs, &method.outputs}) {
        for (const RoleSlot& slot : *slots) sink.record(sink.context, slot.type.c_str());
      }
    }
  }
  return WEFT_OK;
}

std::int32_t create(const Library& library, const Declaration& declaration, const weft_create& with,
                    void** self, weft_error* error) {
  return detail::guarded(error, [&]() -> std::int32_t {
    for (std::uint64_t i = 0; i < with.count; ++i) {
      const auto* end = declaration.parameters + declaration.parameter_count;
      const auto* declared = std::find_if(declaration.parameters, end, [&](const auto& each) {
        return std::strcmp(each.default_value.name, with.values[i].name) == 0;
      });
      const std::string wrong = declared != end ? illegal_value(with.values[i], *declared) : "";
      if (wrong.empty()) continue;
      const std::string name = with.values[i].name;
      return report({Errc::invalid_value, "parameter '" + name + "' " + wrong, {}, name}, error);
    }
    const auto bridge = bridge_of(library);
    if (!bridge) return report(bridge.error(), error);
    const Gil gil;
    const Ref given = python_values(with.values, with.count);
    if (!given) return report({Errc::plugin_failure, "threw: " + raised()}, error);
    BridgeAnswer answer = answer_of(Ref(PyObject_CallMethod(
        *bridge, "create", "ssO", declaration.module, declaration.class_name, given.get())));
    if (answer.status != WEFT_OK) return say(answer, error);
    auto made = std::make_unique<Instance>(Instance{*bridge, std::move(answer.value)});
    *self = made.release();
    return WEFT_OK;
  });
}

std::int32_t prepare(void* self, const weft_call* call, const weft_record* inputs,
                     std::uint64_t count, weft_error* error) {
  return detail::guarded(error, [&]() -> std::int32_t {
    const Instance& instance = *static_cast<Instance*>(self);
    return call_bridge(*call, inputs, count, error, [&](PyObject* object, PyObject* records) {
      return Ref(PyObject_CallMethod(instance.bridge, "prepare", "OOO", instance.component.get(),
                                     object, records));
    });
  });
}

std::int32_t process(void* self, const weft_call* call, const weft_record* inputs,
                     std::uint64_t count, weft_error* error) {
  return detail::guarded(error, [&]() -> std::int32_t {
    const Instance& instance = *static_cast<Instance*>(self);
    return call_bridge(*call, inputs, count, error, [&](PyObject* object, PyObject* records) {
      return Ref(PyObject_CallMethod(instance.bridge, "process", "OOiO", instance.component.get(),
                                     object, static_cast<int>(call->method), records));
    });
  });
}

void destroy(void* self) {
  const Gil gil;
  delete static_cast<Instance*>(self);
}

const void* extension(const Declaration& declaration, const char* name) {
  const std::string_view asked = name;
  if (asked == WEFT_SWEEP) return declaration.sweep;
  if (asked == WEFT_CHECK) return declaration.checks != 0 ? &kCheck : nullptr;
  if (asked == WEFT_ISOLATION) return &kOwnProcess;
  return nullptr;
}

}  // namespace weft::python
