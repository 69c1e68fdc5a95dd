// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/abi.h>

#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>
#include <weft/core/result.hpp>
#include <weft/host/shared_memory.hpp>

namespace weft::host {

/// An array that stays with the library that made it, and its copy here once somebody wanted one.
class DeviceArray {
 public:
  /// Retains the handle. `name` stands in messages, with its component `maker`; the copy is made in
  /// `arena` where one is given.
  DeviceArray(std::string maker, std::string name, const weft_device_memory& library,
              std::uint64_t handle, std::uint64_t bytes, std::shared_ptr<SharedArena> arena);
  ~DeviceArray();
  DeviceArray(const DeviceArray&) = delete;
  DeviceArray& operator=(const DeviceArray&) = delete;

  /// What `array`, which is in device memory, stands for; null when no host made its entry.
  static DeviceArray* of(const weft_array& array) { return static_cast<DeviceArray*>(array.data); }

  const std::string& maker() const { return maker_; }
  const weft_device_memory& library() const { return library_; }
  std::uint64_t bytes() const { return bytes_; }

  /// Fetched at the first call, for `call` if there is one; from any thread.
  struct Copy {
    std::shared_ptr<void> memory;
    weft_memory kind;
    bool is_new;  ///< this call fetched it
  };
  Result<Copy> copy(const weft_call* call = nullptr);

 private:
  std::string maker_, name_;
  const weft_device_memory& library_;
  std::uint64_t handle_;
  std::uint64_t bytes_;
  std::shared_ptr<SharedArena> arena_;
  std::mutex mutex_;
  std::shared_ptr<void> copy_;
};

/// The table behind a component's arrays in device memory, or null.
const weft_device_memory* device_memory_of(const weft_component& component);

/// The inputs of one call as its component can read them.
class ReachableInputs {
 public:
  /// The inputs, with what lies in device memory copied here, unless it belongs to the library
  /// `own`. Fails when an array cannot be fetched, or is illegal once it is here. The records live
  /// as long as this and the inputs.
  Result<std::span<const weft_record>> reach(std::span<const weft_record> inputs,
                                             const weft_device_memory* own, const weft_call& call);

  /// What had to be fetched for this.
  std::uint64_t downloaded_bytes() const { return downloaded_bytes_; }

 private:
  Result<void> fetch(weft_record& record, const weft_device_memory* own, const weft_call& call);

  std::vector<weft_record> records_;
  std::vector<std::vector<weft_array>> arrays_;
  std::uint64_t downloaded_bytes_ = 0;
};

}  // namespace weft::host
