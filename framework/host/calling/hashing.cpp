// SPDX-License-Identifier: Apache-2.0
#include "host/calling/hashing.hpp"

#include <xxhash.h>

#include <atomic>
#include <cstring>
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
  std::uint64_t hash = XXH3_64bits(record.type().data(), record.type().size());
  const auto add = [&hash](const void* bytes, std::size_t count) {
    hash = XXH3_64bits_withSeed(bytes, count, hash);
  };
  for (std::uint64_t i = 0; i < view.count; ++i) {
    const weft_array& array = view.arrays[i];
    add(array.name, std::strlen(array.name));
    add(&array.dtype, sizeof(array.dtype));
    add(array.shape, to_index(array.ndim) * sizeof(array.shape[0]));
    add(array.data, to_index(array_bytes(array.dtype, array.ndim, array.shape)));
  }
  return hash >> 2U | kRevisionOfContent;
}

std::uint64_t next_revision() {
  static std::atomic<std::uint64_t> last{0};
  return ++last;
}

}  // namespace weft::host
