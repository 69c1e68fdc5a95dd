// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <utility>
#include <weft/host/device_array.hpp>
#include <weft/host/record.hpp>

namespace weft::host {
namespace {

/// Whether an array lies where a component that has arrays in `own` cannot read.
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

DeviceArray::DeviceArray(std::string maker, std::string name, const weft_device_memory& library,
                         std::uint64_t handle, std::uint64_t bytes,
                         std::shared_ptr<SharedArena> arena)
    : maker_(std::move(maker)),
      name_(std::move(name)),
      library_(library),
      handle_(handle),
      bytes_(bytes),
      arena_(std::move(arena)) {
  library_.retain(handle_);
}

DeviceArray::~DeviceArray() { library_.release(handle_); }

Result<DeviceArray::Copy> DeviceArray::copy(const weft_call* call) {
  const weft_memory kind = arena_ != nullptr ? WEFT_SHARED : WEFT_HOST;
  const std::lock_guard lock(mutex_);
  if (copy_ != nullptr) return Copy{copy_, kind, false};
  const std::string what = "its array '" + name_ + "' cannot be copied from the device: ";
  std::shared_ptr<void> memory =
      arena_ != nullptr ? arena_->allocate(bytes_) : own_memory(static_cast<std::size_t>(bytes_));
  if (memory == nullptr) return Error{Errc::plugin_failure, what + "memory is short", maker_};
  weft_error error{};
  const std::int32_t status = library_.download(call, handle_, memory.get(), bytes_, &error);
  if (status != WEFT_OK) {
    error.message[sizeof(error.message) - 1] = '\0';
    const std::string reason = *error.message != '\0' ? error.message : "no reason is given";
    const Errc code = status == WEFT_CANCELLED ? Errc::cancelled : Errc::plugin_failure;
    return Error{code, what + reason, maker_};
  }
  copy_ = std::move(memory);
  return Copy{copy_, kind, true};
}

const weft_device_memory* device_memory_of(const weft_component& component) {
  if (component.get_extension == nullptr) return nullptr;
  const auto* library =
      static_cast<const weft_device_memory*>(component.get_extension(WEFT_DEVICE_MEMORY));
  const bool usable = library != nullptr && library->struct_size == sizeof(weft_device_memory) &&
                      library->retain != nullptr && library->release != nullptr &&
                      library->download != nullptr;
  return usable ? library : nullptr;
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
  std::string maker;
  for (weft_array& array : arrays) {
    if (!is_out_of_reach(array, own)) continue;
    DeviceArray* device = DeviceArray::of(array);
    if (device == nullptr) {
      return Error{Errc::plugin_failure,
                   std::string("passed on an array '") + array.name +
                       "' in device memory that is no input; nested components are given what the "
                       "host has handed out",
                   {}};
    }
    const auto copy = device->copy(&call);
    if (!copy) return copy.error();
    array =
        array_at(array.name, array.dtype, array.ndim, array.shape, copy->memory.get(), copy->kind);
    if (copy->is_new) downloaded_bytes_ += device->bytes();
    maker = device->maker();
  }
  record.arrays = arrays.data();
  const auto valid = validate(record);
  if (!valid) return Error{valid.error().code, valid.error().message, maker};
  return {};
}

}  // namespace weft::host
