// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/sdk/device.hpp>

#include "queue.hpp"

namespace weft::sift_gpu {

/// SIFT descriptors [count,128] that stay on their device, in bytes; to others an array of f32.
class KeptDescriptors {
 public:
  /// `rows` hold them once `ready` is complete, and never if it fails.
  KeptDescriptors(std::shared_ptr<Device> device, std::shared_ptr<const cl::Buffer> rows,
                  cl::Event ready, int count)
      : device_(std::move(device)),
        rows_(std::move(rows)),
        ready_(std::move(ready)),
        count_(count) {}

  const Device& device() const { return *device_; }
  const cl::Buffer& rows() const { return *rows_; }
  const cl::Event& ready() const { return ready_; }

  /// Throws cl::Error if it is known that they will never be there.
  void check() const;

  /// Waits until they are there. Throws cl::Error if they never will be, and Cancelled.
  void await(const CancelledCheck& cancelled) const;

  /// Copies them to the host, [count,128], once they are ready; see weft/sdk/device.hpp.
  Result<void> download(std::span<std::byte> to, const CancelledCheck& cancelled) const;

 private:
  std::shared_ptr<Device> device_;
  std::shared_ptr<const cl::Buffer> rows_;
  cl::Event ready_;
  int count_;
};

}  // namespace weft::sift_gpu
