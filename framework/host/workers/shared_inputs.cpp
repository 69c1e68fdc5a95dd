// SPDX-License-Identifier: Apache-2.0
#include "host/workers/shared_inputs.hpp"

#include <algorithm>
#include <cstring>
#include <weft/core/index.hpp>

#include "host/records/record.hpp"

namespace weft::host {
namespace {

/// [bytes] from one entry of axis 0 to the next, were the array contiguous.
std::int64_t row_bytes(const weft_array& array) {
  std::int64_t bytes = dtype_size(array.dtype);
  for (int axis = 1; axis < array.ndim; ++axis) bytes *= array.shape[axis];
  return bytes;
}

bool is_contiguous(const weft_array& array) {
  return array.ndim == 0 || array.stride[0] == row_bytes(array);
}

}  // namespace

Result<PlacedRecord> SharedInputs::place(const weft_record& record,
                                         std::vector<std::shared_ptr<void>>& keep) {
  PlacedRecord placed{record.slot, record.type, record.revision, record.producer, record.frame, {}};
  for (std::uint64_t i = 0; i < record.count; ++i) {
    const weft_array& array = record.arrays[i];
    PlacedArray& target = placed.arrays.emplace_back();
    target.name = array.name;
    target.dtype = array.dtype;
    target.ndim = array.ndim;
    std::copy(std::begin(array.shape), std::end(array.shape), target.shape.begin());
    std::copy(std::begin(array.stride), std::end(array.stride), target.stride.begin());
    if (auto done = place(array, target, keep); !done) return done.error();
  }
  return placed;
}

Result<void> SharedInputs::place(const weft_array& array, PlacedArray& placed,
                                 std::vector<std::shared_ptr<void>>& keep) {
  if (const auto offset = arena_->memory().offset_of(array.data)) {
    placed.offset = *offset;
    return {};
  }
  const std::int64_t bytes = array_bytes(array.dtype, array.ndim, array.shape);
  std::shared_ptr<void> copy;
  {
    const std::lock_guard lock(mutex_);
    const auto found = copies_.find(array.data);
    Copy* shared = found != copies_.end() && is_contiguous(array) ? &found->second : nullptr;
    if (shared != nullptr && shared->memory != nullptr && shared->bytes == bytes) {
      copy = shared->memory;
    } else {
      copy = copy_of(array);
      if (shared != nullptr && shared->memory == nullptr) {
        shared->memory = copy;
        shared->bytes = bytes;
      }
    }
  }
  if (copy == nullptr) {
    return no_room_in_shared_memory(std::string("the input array '") + array.name + "' of " +
                                    std::to_string(bytes) + " bytes");
  }
  placed.offset = *arena_->memory().offset_of(copy.get());
  if (array.ndim > 0) placed.stride[0] = row_bytes(array);
  keep.push_back(std::move(copy));
  return {};
}

std::shared_ptr<void> SharedInputs::copy_of(const weft_array& array) {
  const std::int64_t bytes = array_bytes(array.dtype, array.ndim, array.shape);
  if (bytes < 0) return nullptr;
  std::shared_ptr<void> copy = arena_->allocate(to_index(bytes));
  if (copy == nullptr || bytes == 0) return copy;
  const auto* from = static_cast<const char*>(array.data);
  if (is_contiguous(array)) {
    std::memcpy(copy.get(), from, to_index(bytes));
    return copy;
  }
  const std::int64_t row = row_bytes(array);
  for (std::int64_t i = 0; i < array.shape[0]; ++i) {
    std::memcpy(static_cast<char*>(copy.get()) + i * row, from + i * array.stride[0],
                to_index(row));
  }
  return copy;
}

void SharedInputs::watch(const void* array) {
  const std::lock_guard lock(mutex_);
  ++copies_[array].announced;
}

void SharedInputs::forget(const void* array) {
  const std::lock_guard lock(mutex_);
  const auto found = copies_.find(array);
  if (found != copies_.end() && --found->second.announced == 0) copies_.erase(found);
}

}  // namespace weft::host
