// SPDX-License-Identifier: Apache-2.0
#include "kept_descriptors.hpp"

#include <algorithm>

namespace weft::sift_gpu {

void KeptDescriptors::read(std::span<float> to, const CancelledCheck& cancelled) const {
  Queue queue(device_);
  queue.wait_for(ready_);
  std::vector<std::uint8_t> bytes(to.size());
  queue.read(*rows_, bytes.size(), bytes.data(), cancelled);
  std::copy(bytes.begin(), bytes.end(), to.begin());
}

Result<void> KeptDescriptors::download(std::span<std::byte> to,
                                       const CancelledCheck& cancelled) const {
  const std::string doing =
      "copying " + std::to_string(count_) + " descriptors from " + device_->name();
  try {
    read({reinterpret_cast<float*>(to.data()), to.size() / sizeof(float)}, cancelled);
    return {};
  } catch (const cl::Error& failure) {
    return error_of(failure, doing);
  } catch (const Cancelled&) {
    return Error{Errc::cancelled, "cancelled while " + doing, {}};
  }
}

}  // namespace weft::sift_gpu
