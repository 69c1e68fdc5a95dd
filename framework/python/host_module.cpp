// SPDX-License-Identifier: Apache-2.0
#include "host_module.hpp"

#include <type_traits>
#include <vector>
#include <weft/sdk/roles.hpp>

namespace weft::python {
namespace {

/// Puts `value` into a dict under `key`; false, with an exception, where there is no value.
bool put(const Ref& dict, const char* key, const Ref& value) {
  return dict && value && PyDict_SetItemString(dict.get(), key, value.get()) == 0;
}

/// Visits the fields of a record: array -> (dtype, axes, is text, is optional).
class FieldList {
 public:
  FieldList() : fields_(PyDict_New()) {}

  template <class T>
  void operator()(const Array<T>&, const Field& field) {
    add(field, dtype_of<T>(), false);
  }
  template <class T>
  requires std::is_arithmetic_v<T>
  void operator()(const T&, const Field& field) { add(field, dtype_of<T>(), false); }
  void operator()(const std::string&, const Field& field) { add(field, WEFT_U8, true); }
  void operator()(const NamedArrays&, const Field&) {}
  void operator()(const Diagnostics&, const Field&) {}

  Ref take() { return is_good_ ? std::move(fields_) : Ref(); }

 private:
  void add(const Field& field, std::int32_t dtype, bool is_text) {
    const Ref entry(Py_BuildValue("(isOO)", dtype, field.shape, is_text ? Py_True : Py_False,
                                  field.optional ? Py_True : Py_False));
    is_good_ = is_good_ && put(fields_, field.name, entry);
  }

  Ref fields_;
  bool is_good_ = true;
};

PyObject* catalogue(PyObject*, PyObject*) {
  Ref records(PyDict_New());
  bool is_good = true;
  for_each_record_type([&](auto type) {
    using RecordType = typename decltype(type)::type;
    const RecordType typed{};
    FieldList fields;
    RecordType::fields(typed, fields);
    is_good = is_good && put(records, RecordType::kType, fields.take());
  });
  return is_good ? records.release() : nullptr;
}

Ref slots_of(const std::vector<RoleSlot>& slots) {
  Ref dict(PyDict_New());
  for (const RoleSlot& slot : slots) {
    if (!put(dict, slot.name.c_str(), Ref(PyUnicode_FromString(slot.type.c_str())))) return {};
  }
  return dict;
}

Ref methods_of(const Role& role) {
  Ref list(PyList_New(0));
  for (const RoleMethod& method : role.methods) {
    const Ref inputs = slots_of(method.inputs), outputs = slots_of(method.outputs);
    if (!list || !inputs || !outputs) return {};
    const Ref item(Py_BuildValue("(sOO)", method.name.c_str(), inputs.get(), outputs.get()));
    if (!item || PyList_Append(list.get(), item.get()) != 0) return {};
  }
  return list;
}

PyObject* roles(PyObject*, PyObject*) {
  Ref dict(PyDict_New());
  for (const Role& role : all_roles()) {
    if (!put(dict, role.name.c_str(), methods_of(role))) return nullptr;
  }
  return dict.release();
}

}  // namespace

PyObject* make_host_module() {
  static PyMethodDef methods[] = {{"catalogue", &catalogue, METH_NOARGS, nullptr},
                                  {"roles", &roles, METH_NOARGS, nullptr},
                                  {nullptr, nullptr, 0, nullptr}};
  static PyModuleDef definition = {
      PyModuleDef_HEAD_INIT, "weft.host", nullptr, -1, methods, nullptr, nullptr, nullptr, nullptr};
  return PyModule_Create(&definition);
}

}  // namespace weft::python
