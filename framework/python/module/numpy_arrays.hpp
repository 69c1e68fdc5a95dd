// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/numpy.h>

#include <memory>
#include <variant>
#include <vector>
#include <weft/data/array.hpp>
#include <weft/data/record.hpp>

namespace weft::python {

/// The array as NumPy's, in the same memory, which lives as long as one of both does; None where it
/// is absent. It must own its memory.
template <class T>
pybind11::object numpy_of(const Array<T>& array) {
  if (!array.present()) return pybind11::none();
  const std::vector<std::int64_t> shape(array.shape().begin(),
                                        array.shape().begin() + array.ndim());
  auto kept = std::make_unique<Array<T>>(array);
  T* const elements = kept->data();
  const pybind11::capsule owner(kept.get(),
                                [](void* memory) { delete static_cast<Array<T>*>(memory); });
  static_cast<void>(kept.release());
  return pybind11::array_t<T>(shape, elements, owner);
}

/// Diagnostics by name without "diag.": numbers, and arrays as NumPy's.
inline pybind11::dict named_of(const Diagnostics& diagnostics) {
  pybind11::dict named;
  for (const NamedArray& entry : diagnostics.entries()) {
    const pybind11::str name(std::string(entry.name).substr(5));
    std::visit(
        [&](const auto& values) {
          if (values.ndim() == 0 && values.present()) {
            named[name] = *values.data();
          } else {
            named[name] = numpy_of(values);
          }
        },
        entry.values);
  }
  return named;
}

}  // namespace weft::python
