// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/abi.h>

#include <string>
#include <vector>

#include "python_objects.hpp"

namespace weft::python {

/// One call of a component, and what of it Python is lent. The lock of the interpreter is held
/// wherever it is used.
class CallScope {
 public:
  CallScope(const weft_call& call, const weft_record* inputs, std::uint64_t count);
  ~CallScope() { take_back(); }
  CallScope(const CallScope&) = delete;
  CallScope& operator=(const CallScope&) = delete;

  /// The call as Python sees it, borrowed; null, with an exception, where memory is short.
  PyObject* object() const { return object_.get(); }
  /// [(slot, (type, revision, producer, [(array, memory)]))]
  Ref records(const weft_record* records, std::uint64_t count);
  Ref inputs() { return records(inputs_, input_count_); }

  /// Ends the loan of the memory. Returns the name of an array that still has views, else nothing.
  std::string take_back();

  /// The methods of the call's object; null with an exception.
  PyObject* alloc(PyObject* arguments);
  PyObject* invoke(PyObject* arguments);
  const weft_call& call() const { return call_; }

 private:
  Ref borrowed(Ref memory);

  const weft_call& call_;
  const weft_record* inputs_;
  std::uint64_t input_count_;
  Ref object_;
  std::vector<Ref> borrowed_;
};

}  // namespace weft::python
