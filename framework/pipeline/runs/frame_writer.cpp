// SPDX-License-Identifier: Apache-2.0
#include "pipeline/runs/frame_writer.hpp"

#include <algorithm>

namespace weft {

FrameWriter::FrameWriter(std::size_t bound, Write write)
    : write_(std::move(write)),
      frames_(std::max<std::size_t>(bound, 1)),
      thread_([this] { write_all(); }) {
  pthread_getcpuclockid(thread_.native_handle(), &processor_clock_);
}

FrameWriter::~FrameWriter() {
  {
    const std::lock_guard lock(mutex_);
    is_dropped_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

bool FrameWriter::put(FrameOnItsWay frame) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return failure_ || put_ - written_ < frames_.size(); });
  if (failure_) return false;
  slot(put_++).emplace(std::move(frame));
  changed_.notify_all();
  return true;
}

void FrameWriter::close() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    is_closed_ = true;
  }
  changed_.notify_all();
  thread_.join();
  if (failure_) std::rethrow_exception(failure_);
}

void FrameWriter::write_all() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [&] { return is_dropped_ || is_closed_ || written_ < put_; });
    if (is_dropped_ || written_ == put_) return;
    std::optional<FrameOnItsWay>& frame = slot(written_);  // used here only, until it is written
    lock.unlock();
    std::exception_ptr failure;
    try {
      write_(*frame);
    } catch (...) {
      failure = std::current_exception();
    }
    frame.reset();
    lock.lock();
    failure_ = failure;
    ++written_;
    changed_.notify_all();
    if (failure_) return;
  }
}

}  // namespace weft
