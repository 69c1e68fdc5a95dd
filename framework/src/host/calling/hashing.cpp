// SPDX-License-Identifier: Apache-2.0
#include "host/calling/hashing.hpp"

#include <xxhash.h>

#include <weft/core/index.hpp>
#include <weft/core/inline_vector.hpp>

namespace weft::host {

std::uint64_t component_seed(std::uint64_t run_seed, std::uint64_t frame, std::string_view stage,
                             std::string_view nested_path, std::uint64_t draw) {
  InlineVector<char, 256> bytes;
  const auto add = [&bytes](std::uint64_t number) {
    for (int i = 0; i < 8; ++i) {
      bytes.push_back(static_cast<char>((number >> (8 * i)) & 0xFFU));
    }
  };
  add(run_seed);
  add(frame);
  for (const char c : stage) bytes.push_back(c);
  bytes.push_back('\0');
  for (const char c : nested_path) bytes.push_back(c);
  if (draw != 0) add(draw);
  return XXH3_64bits(bytes.data(), bytes.size());
}

std::uint64_t content_revision(const Record& record) {
  const weft_record view = record.view("");
  std::string digest(record.type());
  for (std::uint64_t i = 0; i < view.count; ++i) {
    const weft_array& array = view.arrays[i];
    std::int64_t bytes = dtype_size(array.dtype);
    digest += '\0';
    digest += array.name;
    for (int axis = 0; axis < array.ndim; ++axis) {
      bytes *= array.shape[axis];
      digest += '\0' + std::to_string(array.shape[axis]);
    }
    const std::uint64_t hash = XXH3_64bits(array.data, to_index(bytes));
    digest.append(reinterpret_cast<const char*>(&hash), sizeof(hash));
  }
  const std::uint64_t revision = XXH3_64bits(digest.data(), digest.size());
  return revision != 0 ? revision : 1;
}

}  // namespace weft::host
