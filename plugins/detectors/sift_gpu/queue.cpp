// SPDX-License-Identifier: Apache-2.0
#include "queue.hpp"

#include <algorithm>
#include <cstring>

namespace weft::sift_gpu {

Queue::Queue(std::shared_ptr<Device> device, bool timed)
    : device_(std::move(device)),
      timed_(timed),
      queue_(device_->context(), device_->handle(), timed ? CL_QUEUE_PROFILING_ENABLE : 0) {}

double Queue::kernel_ms() {
  constexpr double kNanosecondsPerMs = 1e6;
  cl_ulong busy_ns = 0;
  for (const cl::Event& event : launched_) {
    busy_ns += event.getProfilingInfo<CL_PROFILING_COMMAND_END>() -
               event.getProfilingInfo<CL_PROFILING_COMMAND_START>();
  }
  launched_.clear();
  return static_cast<double>(busy_ns) / kNanosecondsPerMs;
}

cl::Kernel Queue::kernel(const char* name) const { return {device_->program(), name}; }

cl::Buffer Queue::buffer(std::uint64_t bytes) const {
  return {device_->context(), CL_MEM_READ_WRITE, std::max<std::uint64_t>(bytes, 1)};
}

void Queue::write(const cl::Buffer& to, const void* from, std::size_t bytes) {
  if (bytes > 0) queue_.enqueueWriteBuffer(to, CL_TRUE, 0, bytes, from);
}

void Queue::fill(const cl::Buffer& buffer, cl_int value) {
  queue_.enqueueFillBuffer(buffer, value, 0, sizeof(value));
}

void Queue::read(const cl::Buffer& from, std::size_t bytes, void* to,
                 const CancelledCheck& cancelled, std::size_t offset_bytes) {
  if (bytes == 0) return;
  // An interrupted read may still arrive: it goes into memory that lives as long as this queue.
  landing_.resize(std::max(landing_.size(), bytes));
  queue_.enqueueReadBuffer(from, CL_FALSE, offset_bytes, bytes, landing_.data(), nullptr, &last_);
  queue_.flush();
  if (!wait_for(last_, cancelled)) throw Cancelled{};
  std::memcpy(to, landing_.data(), bytes);
}

bool Queue::idle() const {
  if (last_() == nullptr) return true;
  const auto status = last_.getInfo<CL_EVENT_COMMAND_EXECUTION_STATUS>();
  return status == CL_COMPLETE || status < 0;
}

}  // namespace weft::sift_gpu
