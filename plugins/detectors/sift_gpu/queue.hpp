// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <cstddef>
#include <vector>

#include "device.hpp"
#include "kernel_sizes.hpp"

namespace weft::sift_gpu {

using CancelledCheck = std::function<bool()>;

/// Thrown when the host cancelled; commands may still be running.
struct Cancelled {};

/// Commands for a device, carried out one after another. All methods throw cl::Error when the
/// device fails; after that, or after Cancelled, the results of the queue are undefined.
class Queue {
 public:
  /// `timed`: the device keeps the time of each kernel, for kernel_ms().
  explicit Queue(std::shared_ptr<Device> device, bool timed = false);
  ~Queue();
  Queue(const Queue&) = delete;
  Queue& operator=(const Queue&) = delete;

  cl::Kernel kernel(const char* name) const;
  cl::Buffer buffer(std::uint64_t bytes) const;

  /// Sends `bytes` that `fill(std::byte*)` writes.
  template <class Fill>
  requires std::invocable<Fill, std::byte*>
  void write(const cl::Buffer& to, std::size_t bytes, Fill&& fill) {
    if (bytes == 0) return;
    fill(staged(bytes));
    send(to, bytes);
  }
  /// Copies first: `from` may be changed at once.
  void write(const cl::Buffer& to, std::size_t bytes, const void* from);

  template <class... Args>
  void launch(cl::Kernel& kernel, const cl::NDRange& items, const cl::NDRange& group,
              const Args&... args) {
    cl_uint index = 0;
    (kernel.setArg(index++, args), ...);
    queue_.enqueueNDRangeKernel(kernel, cl::NullRange, items, group, nullptr, &kernel_);
    last_ = kernel_;
    if (timed_) launched_.push_back(kernel_);
  }

  void fill(const cl::Buffer& buffer, cl_int value);

  /// Sees to it that the device begins with all commands so far.
  void flush() { queue_.flush(); }

  /// The event of the last kernel.
  const cl::Event& last_kernel() const { return kernel_; }

  /// Later commands wait for an event, which may belong to another queue of the same device. If the
  /// event fails, the driver decides whether they run, or ever end: wait for the event too.
  void after(const cl::Event& event);

  /// Waits for all commands so far and copies to the host.
  void read(const cl::Buffer& from, std::size_t bytes, void* to, const CancelledCheck& cancelled,
            std::size_t offset_bytes = 0);

  /// How long the kernels took that were launched since the last call; all must have come to an
  /// end.
  double kernel_ms();

  /// True if all commands have ended. Destroyed before that, it waits for two seconds, then leaks
  /// the memory that transfers may still use; at once where the device reports no state.
  bool idle() const;

 private:
  std::byte* staged(std::size_t bytes);
  void send(const cl::Buffer& to, std::size_t bytes);

  std::shared_ptr<Device> device_;
  bool timed_;
  cl::CommandQueue queue_;
  std::vector<cl::Event> launched_;
  cl::Event kernel_;  ///< the last one
  cl::Event last_;    ///< command of any kind
  // The device copies from and to this, whatever becomes of a call.
  struct Transfers {
    std::vector<std::vector<std::byte>> leaving;  ///< one for each write since the last read
    std::vector<std::byte> landing;
  };
  Transfers transfers_;
  std::size_t writes_ = 0;
};

/// The items of a launch with one group of kGroup for each of `count` things.
inline cl::NDRange groups_for(int count) {
  return cl::NDRange(static_cast<cl::size_type>(count) * kGroup);
}
inline const cl::NDRange& one_group() {
  static const cl::NDRange group(kGroup);
  return group;
}

}  // namespace weft::sift_gpu
