// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/abi.h>

#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>
#include <weft/core/name.hpp>
#include <weft/core/result.hpp>

#include "host/records/memory_pool.hpp"
#include "host/records/shared_memory.hpp"

namespace weft::host {

/// An array that stays with the library that made it, and its copy in host memory after the first
/// request for one.
class DeviceArray {
 public:
  /// Retains the handle of `array`, whose name and shape are legal. `maker` is its component; the
  /// copy is made in `arena` or else in `pool` where one is given.
  DeviceArray(std::string maker, const weft_array& array, const weft_device_memory& library,
              std::shared_ptr<SharedArena> arena, std::shared_ptr<MemoryPool> pool);
  ~DeviceArray();
  DeviceArray(const DeviceArray&) = delete;
  DeviceArray& operator=(const DeviceArray&) = delete;

  /// The DeviceArray behind `array`, which is in device memory; null if no host made its entry.
  static DeviceArray* of(const weft_array& array) { return static_cast<DeviceArray*>(array.owner); }

  const weft_device_memory& library() const { return library_; }

  struct Copy {
    std::shared_ptr<void> memory;
    weft_array array;                ///< the entry of the copy
    std::uint64_t downloaded_bytes;  ///< for this, 0 if it was there
  };
  /// Fetched at the first call, for `call` if there is one; from any thread. The Error, where it
  /// cannot be fetched or holds NaN or infinity, names the maker.
  Result<Copy> copy(const weft_call* call = nullptr);

 private:
  std::string maker_;
  Name name_;
  weft_array array_;
  const weft_device_memory& library_;
  std::shared_ptr<SharedArena> arena_;
  std::shared_ptr<MemoryPool> pool_;
  std::mutex mutex_;
  std::shared_ptr<void> copy_;
};

/// The table behind a component's arrays in device memory; null if it has none. Fails as
/// extension_of().
Result<const weft_device_memory*> device_memory_of(const weft_component& component);

/// The inputs of one call as its component can read them.
class ReachableInputs {
 public:
  /// The inputs, with what lies in device memory copied here, unless it belongs to the library
  /// `own`. Fails as DeviceArray::copy(). The records live as long as this and the inputs.
  Result<std::span<const weft_record>> reach(std::span<const weft_record> inputs,
                                             const weft_device_memory* own, const weft_call& call);

  /// Bytes that were downloaded from the device.
  std::uint64_t downloaded_bytes() const { return downloaded_bytes_; }

 private:
  Result<void> fetch(weft_record& record, const weft_device_memory* own, const weft_call& call);

  std::vector<weft_record> records_;
  std::vector<std::vector<weft_array>> arrays_;
  std::uint64_t downloaded_bytes_ = 0;
};

}  // namespace weft::host
