// SPDX-License-Identifier: Apache-2.0
#include "queue.hpp"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <thread>

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

Queue::~Queue() {
  constexpr auto kPatience = std::chrono::seconds(2);
  constexpr auto kPause = std::chrono::microseconds(200);
  const auto start = std::chrono::steady_clock::now();
  bool ended = false;
  try {
    ended = idle();
    if (!ended) queue_.flush();  // a command that was never submitted would never end
    while (!ended && std::chrono::steady_clock::now() - start < kPatience) {
      std::this_thread::sleep_for(kPause);
      ended = idle();
    }
  } catch (const cl::Error&) {
    ended = false;  // a lost device does not report whether it still writes
  }
  if (!ended) static_cast<void>(std::make_unique<Transfers>(std::move(transfers_)).release());
}

std::byte* Queue::staged(std::size_t bytes) {
  std::vector<std::vector<std::byte>>& leaving = transfers_.leaving;
  if (writes_ == leaving.size()) leaving.emplace_back();
  leaving[writes_].resize(bytes);
  return leaving[writes_].data();
}

void Queue::send(const cl::Buffer& to, std::size_t bytes) {
  queue_.enqueueWriteBuffer(to, CL_FALSE, 0, bytes, transfers_.leaving[writes_++].data(), nullptr,
                            &last_);
}

void Queue::write(const cl::Buffer& to, std::size_t bytes, const void* from) {
  write(to, bytes, [&](std::byte* target) { std::memcpy(target, from, bytes); });
}

void Queue::fill(const cl::Buffer& buffer, cl_int value) {
  queue_.enqueueFillBuffer(buffer, value, 0, sizeof(value), nullptr, &last_);
}

void Queue::after(const cl::Event& event) {
  const std::vector<cl::Event> events{event};
  queue_.enqueueBarrierWithWaitList(&events);
}

void Queue::read(const cl::Buffer& from, std::size_t bytes, void* to,
                 const CancelledCheck& cancelled, std::size_t offset_bytes) {
  if (bytes == 0) return;
  std::vector<std::byte>& landing = transfers_.landing;
  landing.resize(std::max(landing.size(), bytes));
  queue_.enqueueReadBuffer(from, CL_FALSE, offset_bytes, bytes, landing.data(), nullptr, &last_);
  queue_.flush();
  if (!wait_for(last_, cancelled)) throw Cancelled{};
  writes_ = 0;
  std::memcpy(to, landing.data(), bytes);
}

bool Queue::idle() const {
  if (last_() == nullptr) return true;
  const auto status = last_.getInfo<CL_EVENT_COMMAND_EXECUTION_STATUS>();
  return status == CL_COMPLETE || status < 0;
}

}  // namespace weft::sift_gpu
