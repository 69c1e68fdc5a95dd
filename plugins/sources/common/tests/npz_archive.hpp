// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <zip.h>

#include <map>
#include <stdexcept>
#include <string>
#include <weft/data/npy.hpp>

namespace weft::testing {

/// An array as numpy.savez() writes it.
template <class T>
std::string npy(const Array<T>& values) {
  weft_array array{};
  array.dtype = dtype_of<T>();
  array.ndim = values.ndim();
  std::int64_t stride = sizeof(T);
  for (int axis = array.ndim - 1; axis >= 0; --axis) {
    array.shape[axis] = values.dim(axis);
    array.stride[axis] = stride;
    stride *= values.dim(axis);
  }
  array.data = const_cast<T*>(values.data());
  return to_npy(array);
}

inline void write_archive(const std::string& path,
                          const std::map<std::string, std::string>& members) {
  zip_t* archive = zip_open(path.c_str(), ZIP_CREATE | ZIP_TRUNCATE, nullptr);
  for (const auto& [name, bytes] : members) {
    zip_source_t* source = zip_source_buffer(archive, bytes.data(), bytes.size(), 0);
    zip_file_add(archive, name.c_str(), source, 0);
  }
  if (zip_close(archive) != 0) throw std::runtime_error("cannot write " + path);
}

}  // namespace weft::testing
