// SPDX-License-Identifier: Apache-2.0
#include "host/calling/protected_inputs.hpp"

#include <sys/mman.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <cstring>
#include <string>
#include <weft/core/index.hpp>

#include "host/records/record.hpp"

namespace weft::host {
namespace {

constexpr std::size_t kPage = 4096, kInputAlignment = 64;

/// The part of some protected pages that a signal handler can identify: it ends at the end of the
/// readable pages.
struct Known {
  std::atomic<std::uintptr_t> start{0};  ///< 0: free, 1: being taken
  std::uintptr_t end = 0;
  std::array<char, 96> name{};
};
// Handlers reach nothing but objects with static storage.
std::array<Known, 256> all_known;

static_assert(std::atomic<std::uintptr_t>::is_always_lock_free);

/// Without a free place the pages have no name.
void know(const std::byte* start, std::size_t bytes, const std::string& name) {
  for (Known& known : all_known) {
    std::uintptr_t free = 0;
    if (!known.start.compare_exchange_strong(free, 1)) continue;
    const std::size_t length = std::min(name.size(), known.name.size() - 1);
    std::copy_n(name.begin(), length, known.name.begin());
    known.name[length] = '\0';
    known.end = reinterpret_cast<std::uintptr_t>(start) + bytes;
    known.start = reinterpret_cast<std::uintptr_t>(start);
    return;
  }
}

void forget(const std::byte* start) {
  const auto place = reinterpret_cast<std::uintptr_t>(start);
  for (Known& known : all_known) {
    if (known.start == place) known.start = 0;
  }
}

constexpr std::size_t rounded_up(std::size_t bytes, std::size_t unit) {
  return (bytes + unit - 1) / unit * unit;
}

}  // namespace

ProtectedInputs::~ProtectedInputs() {
  for (const Pages& pages : pages_) {
    forget(pages.start);
    munmap(pages.start, pages.bytes);
  }
}

Result<std::span<const weft_record>> ProtectedInputs::copy(std::span<const weft_record> inputs) {
  records_.assign(inputs.begin(), inputs.end());
  arrays_.reserve(records_.size());
  for (weft_record& record : records_) {
    auto& arrays = arrays_.emplace_back(record.arrays, record.arrays + record.count);
    for (weft_array& array : arrays) {
      if (array.memory == WEFT_DEVICE) continue;
      if (auto done = protect(record, array); !done) return done.error();
    }
    record.arrays = arrays.data();
  }
  return std::span<const weft_record>(records_);
}

/// The array ends, as closely as its alignment allows, where nothing can be read any more.
Result<void> ProtectedInputs::protect(const weft_record& record, weft_array& array) {
  const auto bytes = to_index(array_bytes(array.dtype, array.ndim, array.shape));
  const std::size_t readable = std::max(rounded_up(bytes, kPage), kPage);
  void* const mapped =
      mmap(nullptr, readable + kPage, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (mapped == MAP_FAILED) return Error{Errc::no_memory, "out of memory", {}};
  auto* const start = static_cast<std::byte*>(mapped);
  pages_.push_back({start, readable + kPage});
  if (mprotect(start, readable, PROT_READ | PROT_WRITE) != 0) {
    return Error{Errc::no_memory, "out of memory", {}};
  }
  std::byte* const data = start + readable - rounded_up(bytes, kInputAlignment);
  const std::int64_t rows = array.ndim > 0 ? array.shape[0] : 1;
  const std::size_t row_bytes = rows > 0 ? bytes / to_index(rows) : 0;
  for (std::int64_t i = 0; row_bytes > 0 && i < rows; ++i) {
    const auto* from = static_cast<const std::byte*>(array.data);
    if (array.ndim > 0) from += i * array.stride[0];
    std::memcpy(data + to_index(i) * row_bytes, from, row_bytes);
  }
  if (mprotect(start, readable, PROT_READ) != 0) {
    return Error{Errc::no_memory, "out of memory", {}};
  }
  array = array_at(array.name, array.dtype, array.ndim, array.shape, data,
                   static_cast<weft_memory>(array.memory));
  know(start, readable, std::string(record.slot) + "/" + array.name);
  return {};
}

ProtectedPlace protected_place(const void* address) {
  const auto place = reinterpret_cast<std::uintptr_t>(address);
  for (const Known& known : all_known) {
    const std::uintptr_t start = known.start;
    if (start > 1 && place >= start && place < known.end + kPage) {
      return {known.name.data(), place >= known.end};
    }
  }
  return {nullptr, false};
}

}  // namespace weft::host
