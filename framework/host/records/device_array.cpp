// SPDX-License-Identifier: Apache-2.0
#include "host/records/device_array.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "host/guarding/library_call.hpp"
#include "host/records/plugin_error.hpp"
#include "host/records/record.hpp"

namespace weft::host {
namespace {

/// True if an array is in memory that a component with arrays in `own` cannot read.
bool is_out_of_reach(const weft_array& array, const weft_device_memory* own) {
  if (array.memory != WEFT_DEVICE) return false;
  const DeviceArray* device = DeviceArray::of(array);
  return device == nullptr || &device->library() != own;
}

bool is_out_of_reach(const weft_record& record, const weft_device_memory* own) {
  return std::any_of(record.arrays, record.arrays + record.count,
                     [&](const weft_array& array) { return is_out_of_reach(array, own); });
}

}  // namespace

DeviceArray::DeviceArray(std::string maker, const weft_array& array,
                         const weft_device_memory& library, std::shared_ptr<SharedArena> arena,
                         std::shared_ptr<MemoryPool> pool)
    : maker_(std::move(maker)),
      name_(std::string_view(array.name)),
      array_(array),
      library_(library),
      arena_(std::move(arena)),
      pool_(std::move(pool)) {
  array_.name = name_.c_str();
  weft_error error = kNoError;
  const std::int32_t status =
      call_library(maker_.c_str(), error, [&] { library_.retain(array_.handle); });
  if (status != WEFT_OK) throw std::runtime_error(maker_ + ": retain() " + error.message);
}

/// An exception of release() ends here: no call is left that could report it.
DeviceArray::~DeviceArray() {
  weft_error error = kNoError;
  call_library(maker_.c_str(), error, [&] { library_.release(array_.handle); });
}

Result<DeviceArray::Copy> DeviceArray::copy(const weft_call* call) {
  const auto failed = [&](const std::string& reason, Errc code = Errc::plugin_failure) {
    return Error{code, "its array '" + std::string(name_) + "', which lies on a device, " + reason,
                 maker_};
  };
  const auto bytes =
      static_cast<std::uint64_t>(array_bytes(array_.dtype, array_.ndim, array_.shape));
  const weft_memory kind = arena_ != nullptr ? WEFT_SHARED : WEFT_HOST;
  const auto entry_at = [&](void* data) {
    return array_at(array_.name, array_.dtype, array_.ndim, array_.shape, data, kind);
  };
  const std::lock_guard lock(mutex_);
  if (copy_ != nullptr) return Copy{copy_, entry_at(copy_.get()), 0};
  std::shared_ptr<void> memory =
      arena_ != nullptr ? arena_->allocate(bytes) : own_memory(bytes, pool_);
  if (memory == nullptr) return failed("cannot be copied: memory is short");
  weft_error error = kNoError;
  const std::int32_t status = call_library(maker_.c_str(), error, [&] {
    return library_.download(call, array_.handle, memory.get(), bytes, &error);
  });
  if (status != WEFT_OK) {
    return failed("cannot be copied: " + plugin_error(status, error, maker_).message,
                  status == WEFT_CANCELLED ? Errc::cancelled : Errc::plugin_failure);
  }
  if (!is_finite(entry_at(memory.get()))) return failed("holds NaN or infinity");
  copy_ = std::move(memory);
  return Copy{copy_, entry_at(copy_.get()), bytes};
}

Result<const weft_device_memory*> device_memory_of(const weft_component& component) {
  const auto found = extension_of<weft_device_memory>(component, WEFT_DEVICE_MEMORY);
  if (!found || *found == nullptr) return found;
  const weft_device_memory& table = **found;
  if (table.retain != nullptr && table.release != nullptr && table.download != nullptr)
    return found;
  return Error{Errc::plugin_failure, "its table of device memory lacks a function", component.id};
}

Result<std::span<const weft_record>> ReachableInputs::reach(std::span<const weft_record> inputs,
                                                            const weft_device_memory* own,
                                                            const weft_call& call) {
  if (std::none_of(inputs.begin(), inputs.end(),
                   [&](const weft_record& record) { return is_out_of_reach(record, own); })) {
    return inputs;
  }
  records_.assign(inputs.begin(), inputs.end());
  for (weft_record& record : records_) {
    if (!is_out_of_reach(record, own)) continue;
    if (auto fetched = fetch(record, own, call); !fetched) return fetched.error();
  }
  return std::span<const weft_record>(records_);
}

Result<void> ReachableInputs::fetch(weft_record& record, const weft_device_memory* own,
                                    const weft_call& call) {
  std::vector<weft_array>& arrays =
      arrays_.emplace_back(record.arrays, record.arrays + record.count);
  for (weft_array& array : arrays) {
    if (!is_out_of_reach(array, own)) continue;
    DeviceArray* device = DeviceArray::of(array);
    if (device == nullptr) {
      return Error{Errc::plugin_failure,
                   std::string("passed on an array '") + array.name +
                       "' in device memory that is no input; nested components are given what the "
                       "host has handed out"};
    }
    const auto copy = device->copy(&call);
    if (!copy) return copy.error();
    array = copy->array;
    downloaded_bytes_ += copy->downloaded_bytes;
  }
  record.arrays = arrays.data();
  return {};
}

}  // namespace weft::host
