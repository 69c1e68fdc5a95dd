// SPDX-License-Identifier: Apache-2.0
#include "host/calling/hashing.hpp"

#include <xxhash.h>

#include <array>
#include <atomic>
#include <cstring>
#include <string>
#include <weft/core/index.hpp>

namespace weft::host {

std::uint64_t component_seed(std::uint64_t run_seed, std::uint64_t frame, std::string_view stage,
                             std::string_view nested_path, std::uint64_t draw) {
  std::array<char, 256> small;
  std::string large;
  const std::size_t size =
      2 * sizeof(run_seed) + stage.size() + 1 + nested_path.size() + (draw != 0 ? sizeof(draw) : 0);
  if (size > small.size()) large.resize(size);
  char* const bytes = large.empty() ? small.data() : large.data();
  char* end = bytes;
  const auto add = [&end](const void* part, std::size_t length) {
    std::memcpy(end, part, length);
    end += length;
  };
  add(&run_seed, sizeof(run_seed));  // little-endian, as this processor stores it
  add(&frame, sizeof(frame));
  add(stage.data(), stage.size());
  *end++ = '\0';
  add(nested_path.data(), nested_path.size());
  if (draw != 0) add(&draw, sizeof(draw));
  return XXH3_64bits(bytes, size);
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
