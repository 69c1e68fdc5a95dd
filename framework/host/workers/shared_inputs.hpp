// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/abi.h>

#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "host/records/shared_memory.hpp"
#include "host/workers/message.hpp"

namespace weft::host {

/// Places the inputs of workers in memory that all of them read. Arrays that were allocated there
/// are not copied. An array that a worker made is copied when another worker first reads it, and
/// the copy lives as long as the array. All other arrays are copied for each call.
class SharedInputs {
 public:
  explicit SharedInputs(std::shared_ptr<SharedArena> arena) : arena_(std::move(arena)) {}

  const std::shared_ptr<SharedArena>& arena() const { return arena_; }

  /// Copies that no other reader shares are added to `keep`. Fails when the memory is full.
  Result<PlacedRecord> place(const weft_record& record, std::vector<std::shared_ptr<void>>& keep);

  /// Announces an array in the memory of a worker, and its end; from any thread.
  void watch(const void* array);
  void forget(const void* array);

 private:
  std::shared_ptr<void> copy_of(const weft_array& array);
  Result<void> place(const weft_array& array, PlacedArray& placed,
                     std::vector<std::shared_ptr<void>>& keep);

  struct Copy {
    std::shared_ptr<void> memory;  ///< null until it is wanted
    std::int64_t bytes = 0;        ///< [bytes] size of the copy
    int announced = 0;
  };
  std::shared_ptr<SharedArena> arena_;
  std::mutex mutex_;
  std::map<const void*, Copy> copies_;  ///< copies of arrays that workers made
};

}  // namespace weft::host
