// SPDX-License-Identifier: Apache-2.0
#include "device_choice.hpp"

namespace weft::sift_gpu {

void DeviceChoice::read(Params& p) {
  p.text("device", wanted_,
         "index, or part of the name or of the vendor, of an OpenCL device of `weft doctor`; gpu "
         "takes the first GPU, empty the first GPU, else the first device");
  p.choice("without_device", without_device_,
           {{"error", WithoutDevice::error}, {"fallback", WithoutDevice::fallback}},
           "where no such device is: an error before the first frame, or the component of "
           "`fallback`, each frame then being flagged");
}

Result<void> DeviceChoice::prepare() {
  const auto opened = open();
  if (!opened) return opened.error();
  stands_back_ = *opened == nullptr;
  return {};
}

Result<std::shared_ptr<Device>> DeviceChoice::open() {
  if (device_ != nullptr && device_->is_retired()) device_.reset();
  if (device_ != nullptr || stands_back_) return device_;
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
