// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/abi.h>

#include <cstdint>
#include <weft/sdk/isa.hpp>

namespace weft::python {

/// A module that travels in a library.
struct Source {
  const char* name;  ///< "local_motion", "weft.records"
  const char* file;  ///< as errors name it
  const char* text;
  int is_package;  ///< 0 or 1
  int is_own;      ///< the author's, not of the package `weft`
};

/// Declarations of a component's class beyond those in its weft_component.
struct Declaration {
  const char* module;
  const char* class_name;
  const weft_parameter* parameters;
  std::uint64_t parameter_count;
  const char* role;
  const weft_sweep* sweep;  ///< null where it has none
  int checks;               ///< it has a method `check`
};

/// All that a library of components in Python is made of; embed.py writes it. One a shared object.
struct Library {
  const Source* sources;
  std::uint64_t source_count;
  const Declaration* declarations;  ///< declarations of each component
};

std::int32_t describe(const Declaration& declaration, const weft_describe& sink);
std::int32_t create(const Library& library, const Declaration& declaration, const weft_create& with,
                    void** self, weft_error* error);
std::int32_t prepare(void* self, const weft_call* call, const weft_record* inputs,
                     std::uint64_t count, weft_error* error);
std::int32_t process(void* self, const weft_call* call, const weft_record* inputs,
                     std::uint64_t count, weft_error* error);
void destroy(void* self);
const void* extension(const Declaration& declaration, const char* name);

/// The functions of the contract that depend on their component.
template <const Library& kLibrary, int kIndex>
struct Functions {
  static std::int32_t describe(const weft_describe* sink, weft_error* /*error*/) {
    return python::describe(kLibrary.declarations[kIndex], *sink);
  }
  static std::int32_t create(const weft_create* with, void** self, weft_error* error) {
    return python::create(kLibrary, kLibrary.declarations[kIndex], *with, self, error);
  }
  static const void* get_extension(const weft_component* /*component*/, const char* name) {
    return python::extension(kLibrary.declarations[kIndex], name);
  }
};

}  // namespace weft::python
