// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "device.hpp"

namespace weft::sift_gpu {

using CancelledCheck = std::function<bool()>;

/// Thrown when the host asked to stop; commands may still be running.
struct Cancelled {};

/// Commands for a device, carried out one after another. All methods throw cl::Error when the
/// device fails; after that, or after Cancelled, what was asked of the queue is worth nothing.
class Queue {
 public:
  /// `timed`: the device keeps the time of each kernel, for kernel_ms().
  explicit Queue(std::shared_ptr<Device> device, bool timed = false);

  const Device& device() const { return *device_; }
  cl::Kernel kernel(const char* name) const;
  cl::Buffer buffer(std::uint64_t bytes) const;

  /// Returns when `from` may be changed again.
  void write(const cl::Buffer& to, const void* from, std::size_t bytes);

  template <class... Args>
  void launch(cl::Kernel& kernel, const cl::NDRange& items, const cl::NDRange& group,
              const Args&... args) {
    cl_uint index = 0;
    (kernel.setArg(index++, args), ...);
    cl::Event* event = timed_ ? &launched_.emplace_back() : nullptr;
    queue_.enqueueNDRangeKernel(kernel, cl::NullRange, items, group, nullptr, event);
  }

  void fill(const cl::Buffer& buffer, cl_int value);

  /// Waits for all commands so far and copies to the host.
  void read(const cl::Buffer& from, std::size_t bytes, void* to, const CancelledCheck& cancelled,
            std::size_t offset_bytes = 0);

  /// How long the kernels took that were launched since the last call; all must have come to an
  /// end.
  double kernel_ms();

  /// Whether all commands have come to an end. Before that it must not be destroyed: a read that
  /// was interrupted may still arrive.
  bool idle() const;

 private:
  std::shared_ptr<Device> device_;
  bool timed_;
  cl::CommandQueue queue_;
  std::vector<cl::Event> launched_;
  cl::Event last_;
  std::vector<std::byte> landing_;
};

/// The items of a launch with one group of kGroup for each of `count` things.
inline constexpr int kGroup = 32;
inline cl::NDRange groups_for(int count) {
  return cl::NDRange(static_cast<cl::size_type>(count) * kGroup);
}
inline const cl::NDRange& one_group() {
  static const cl::NDRange group(kGroup);
  return group;
}

}  // namespace weft::sift_gpu
