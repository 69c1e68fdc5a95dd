// SPDX-License-Identifier: Apache-2.0
#include "kept_descriptors.hpp"

#include <algorithm>

namespace weft::sift_gpu {

void KeptDescriptors::check() const {
  const auto status = ready_.getInfo<CL_EVENT_COMMAND_EXECUTION_STATUS>();
  if (status < 0) throw cl::Error(status, "describing keypoints");
}

void KeptDescriptors::await(const CancelledCheck& cancelled) const {
  if (!wait_for(ready_, cancelled)) throw Cancelled{};
}

Result<void> KeptDescriptors::download(std::span<std::byte> to,
                                       const CancelledCheck& cancelled) const {
  const std::string doing =
      "copying " + std::to_string(count_) + " descriptors from " + device_->name();
  try {
    await(cancelled);
    std::vector<std::uint8_t> bytes(to.size() / sizeof(float));
    Queue(device_).read(*rows_, bytes.size(), bytes.data(), cancelled);
    std::copy(bytes.begin(), bytes.end(), reinterpret_cast<float*>(to.data()));
    return {};
  } catch (const cl::Error& failure) {
    Error error = error_of(failure, doing);
    if (device_->is_retired()) error.message += ": lost with their device; start the run again";
    return error;
  } catch (const Cancelled&) {
    return Error{Errc::cancelled, "cancelled while " + doing};
  }
}

}  // namespace weft::sift_gpu
