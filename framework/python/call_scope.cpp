// SPDX-License-Identifier: Apache-2.0
#include "call_scope.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>
#include <weft/sdk/process.hpp>

#include "borrowed_memory.hpp"
#include "call_object.hpp"

namespace weft::python {
namespace {

/// The members of a record beside its arrays, which Python passes on as bytes.
struct RecordOrigin {
  std::int64_t frame = WEFT_NO_FRAME;
  std::int32_t view = 0, object = 0;
  std::array<std::uint64_t, 3> reserved{};
};

/// Records that Python passes to another component, for as long as their arrays are held.
class PassedRecords {
 public:
  PassedRecords() = default;
  ~PassedRecords() {
    for (Py_buffer& buffer : buffers_) PyBuffer_Release(&buffer);
  }
  PassedRecords(const PassedRecords&) = delete;
  PassedRecords& operator=(const PassedRecords&) = delete;

  /// Reads [(slot, type, revision, producer, origin, [(name, dtype, array)])]; false with an
  /// exception.
  bool read(PyObject* list) {
    const Py_ssize_t count = PyList_Size(list);
    arrays_.reserve(count > 0 ? static_cast<std::size_t>(count) : 0);
    for (Py_ssize_t i = 0; i < count; ++i) {
      weft_record record{};
      unsigned long long revision = 0, producer = 0;
      PyObject* arrays = nullptr;
      const char* origin = nullptr;
      Py_ssize_t origin_bytes = 0;
      if (PyArg_ParseTuple(PyList_GetItem(list, i), "ssKKy#O!", &record.slot, &record.type,
                           &revision, &producer, &origin, &origin_bytes, &PyList_Type,
                           &arrays) == 0) {
        return false;
      }
      RecordOrigin of;
      if (origin_bytes == Py_ssize_t{sizeof(of)}) std::memcpy(&of, origin, sizeof(of));
      std::vector<weft_array>& of_record = arrays_.emplace_back();
      for (Py_ssize_t k = 0; k < PyList_Size(arrays); ++k) {
        if (!read_array(PyList_GetItem(arrays, k), of_record.emplace_back())) return false;
      }
      record.revision = revision;
      record.producer = producer;
      record.frame = of.frame;
      record.view = of.view;
      record.object = of.object;
      std::copy(of.reserved.begin(), of.reserved.end(), record.reserved);
      record.count = of_record.size();
      record.arrays = of_record.data();
      records_.push_back(record);
    }
    return count >= 0;
  }

  const std::vector<weft_record>& records() const { return records_; }

 private:
  bool read_array(PyObject* item, weft_array& array) {
    array = {};
    PyObject* object = nullptr;
    if (PyArg_ParseTuple(item, "siO", &array.name, &array.dtype, &object) == 0) return false;
    Py_buffer buffer{};
    if (PyObject_GetBuffer(object, &buffer, PyBUF_C_CONTIGUOUS) != 0) return false;
    buffers_.push_back(buffer);
    if (buffer.ndim > WEFT_MAX_DIMENSIONS) {
      PyErr_SetString(PyExc_TypeError, "an array has too many axes");
      return false;
    }
    array.ndim = buffer.ndim;
    array.data = buffer.buf;
    for (int axis = 0; axis < buffer.ndim; ++axis) {
      array.shape[axis] = buffer.shape[axis];
      array.stride[axis] = buffer.strides[axis];
    }
    return true;
  }

  std::vector<Py_buffer> buffers_;
  std::vector<std::vector<weft_array>> arrays_;
  std::vector<weft_record> records_;
};

}  // namespace

CallScope::CallScope(const weft_call& call, const weft_record* inputs, std::uint64_t count)
    : call_(call), inputs_(inputs), input_count_(count), object_(make_call_object(*this)) {}

Ref CallScope::borrowed(Ref memory) {
  if (memory) borrowed_.push_back(Ref::to(memory.get()));
  return memory;
}

Ref CallScope::records(const weft_record* records, std::uint64_t count) {
  Ref list(PyList_New(0));
  for (std::uint64_t i = 0; list && i < count; ++i) {
    const weft_record& record = records[i];
    Ref arrays(PyList_New(0));
    for (std::uint64_t k = 0; arrays && k < record.count; ++k) {
      const weft_array& array = record.arrays[k];
      if (array.memory == WEFT_DEVICE || dtype_size(array.dtype) == 0) continue;
      const Ref memory = borrowed(lend(record.slot, array.name, array.data, array.dtype, array.ndim,
                                       array.shape, array.stride, false));
      const Ref item(memory ? Py_BuildValue("(sO)", array.name, memory.get()) : nullptr);
      if (!item || PyList_Append(arrays.get(), item.get()) != 0) return {};
    }
    if (!arrays) return {};
    const RecordOrigin of{record.frame, record.view, record.object, std::to_array(record.reserved)};
    const Ref item(Py_BuildValue(
        "(s(sKKy#O))", record.slot, record.type, static_cast<unsigned long long>(record.revision),
        static_cast<unsigned long long>(record.producer), reinterpret_cast<const char*>(&of),
        Py_ssize_t{sizeof(of)}, arrays.get()));
    if (!item || PyList_Append(list.get(), item.get()) != 0) return {};
  }
  return list;
}

std::string CallScope::take_back() {
  const auto is_seen = [](const Ref& memory) { return memory_in(memory.get()).views > 0; };
  auto kept = std::find_if(borrowed_.begin(), borrowed_.end(), is_seen);
  if (kept != borrowed_.end()) {
    PyGC_Collect();  // unreachable objects are no views
    kept = std::find_if(kept, borrowed_.end(), is_seen);
  }
  std::string name;
  if (kept != borrowed_.end()) {
    const BorrowedMemory& memory = memory_in(kept->get());
    name = std::string(memory.slot) + "/" + memory.name;
  }
  for (const Ref& memory : borrowed_) memory_in(memory.get()).is_over = true;
  borrowed_.clear();
  if (object_) end_call_object(object_.get());
  object_ = {};
  return name;
}

PyObject* CallScope::alloc(PyObject* arguments) {
  const char *slot = nullptr, *type = nullptr, *name = nullptr;
  int dtype = 0;
  PyObject* axes = nullptr;
  if (PyArg_ParseTuple(arguments, "sssiO!", &slot, &type, &name, &dtype, &PyTuple_Type, &axes) ==
      0) {
    return nullptr;
  }
  const Py_ssize_t ndim = PyTuple_Size(axes);
  std::array<std::int64_t, WEFT_MAX_DIMENSIONS> shape{};
  if (ndim > WEFT_MAX_DIMENSIONS) Py_RETURN_NONE;
  for (Py_ssize_t axis = 0; axis < ndim; ++axis) {
    shape[static_cast<std::size_t>(axis)] = PyLong_AsLongLong(PyTuple_GetItem(axes, axis));
  }
  if (PyErr_Occurred() != nullptr) return nullptr;
  void* data =
      weft_alloc(&call_, slot, type, name, dtype, static_cast<std::int32_t>(ndim), shape.data());
  if (data == nullptr) Py_RETURN_NONE;
  // The host keeps no names for us, and those of Python may be gone when the call ends.
  return borrowed(lend("its outputs", "an array", data, dtype, static_cast<std::int32_t>(ndim),
                       shape.data(), nullptr, true))
      .release();
}

PyObject* CallScope::invoke(PyObject* arguments) {
  unsigned long long component = 0;
  int method = 0;
  PyObject* list = nullptr;
  if (PyArg_ParseTuple(arguments, "KiO!", &component, &method, &PyList_Type, &list) == 0) {
    return nullptr;
  }
  PassedRecords passed;
  if (!passed.read(list)) return nullptr;
  weft_invocation asked{};
  asked.struct_size = sizeof(weft_invocation);
  asked.method = method;
  asked.component = component;
  asked.inputs = passed.records().data();
  asked.input_count = passed.records().size();
  asked.frame = call_.frame;
  weft_error error = kNoError;
  std::int32_t status = WEFT_ERROR;
  {
    const WithoutGil others;
    status = call_.host->invoke(&call_, &asked, &error);
  }
  const bool usable = status == WEFT_OK || status == WEFT_DEGENERATE;
  const Ref answer = records(asked.outputs, usable ? asked.output_count : 0);
  if (!answer) return nullptr;
  return Py_BuildValue("(iisO)", status, error.code, error.message, answer.get());
}

}  // namespace weft::python
