// SPDX-License-Identifier: Apache-2.0
#include "device_choice.hpp"

namespace weft::sift_gpu {

void DeviceChoice::read(Params& p) {
  p.text("device", wanted_,
         "OpenCL device, by index or by part of its name or vendor in `weft doctor`; gpu: first "
         "GPU; empty: first GPU, else first device");
  p.choice("without_device", without_device_,
           {{"error", WithoutDevice::error}, {"fallback", WithoutDevice::fallback}},
           "behaviour without such a device; error: an error before the first frame; fallback: the "
           "component of `fallback`, each frame being flagged");
}

Result<void> DeviceChoice::prepare() {
  const auto opened = open();
  if (!opened) return opened.error();
  has_no_device_ = *opened == nullptr;
  return {};
}

Result<std::shared_ptr<Device>> DeviceChoice::open() {
  if (device_ != nullptr && device_->is_retired()) device_.reset();
  if (device_ != nullptr || has_no_device_) return device_;
  if (auto device = Device::open(wanted_)) {
    device_ = *std::move(device);
  } else if (without_device_ == WithoutDevice::error) {
    Error error = device.error();
    error.message += "; or set without_device: fallback";
    return error;
  } else {
    reason_ = device.error().message;
  }
  return device_;
}

}  // namespace weft::sift_gpu
