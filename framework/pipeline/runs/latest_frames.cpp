// SPDX-License-Identifier: Apache-2.0
#include "pipeline/runs/latest_frames.hpp"

#include <algorithm>
#include <weft/data/image.hpp>

namespace weft {
namespace {

/// [s] when the frame was taken, if the source reports it.
std::optional<double> time_of(const PipelineInput::Frame& frame) {
  const host::RecordPtr record = frame.input.find("time");
  if (record == nullptr) return std::nullopt;
  const auto time = host::view_as<Time>(*record);
  return time ? std::optional(time->t_s) : std::nullopt;
}

}  // namespace

LatestFrames::LatestFrames(Source source, Clock& clock)
    : source_(std::move(source)), clock_(clock), thread_([this] { read_all(); }) {}

LatestFrames::~LatestFrames() {
  stop();
  thread_.join();
}

void LatestFrames::stop() {
  {
    const std::lock_guard lock(mutex_);
    is_stopped_ = true;
  }
  changed_.notify_all();
}

std::optional<PipelineInput::Frame> LatestFrames::take(const std::function<bool()>& cancelled) {
  constexpr std::chrono::milliseconds kAskEvery{5};  // a signal handler cannot wake a thread
  std::unique_lock lock(mutex_);
  while (!newest_ && !has_ended_ && !cancelled()) changed_.wait_for(lock, kAskEvery);
  if (!newest_ && failure_) std::rethrow_exception(failure_);
  if (cancelled()) return std::nullopt;
  auto taken = std::exchange(newest_, std::nullopt);
  changed_.notify_all();
  return taken;
}

void LatestFrames::read_all() {
  std::exception_ptr failure;
  try {
    for (std::uint64_t index = 0; read_next(index); ++index) continue;
  } catch (...) {
    failure = std::current_exception();
  }
  {
    const std::lock_guard lock(mutex_);
    failure_ = failure;
    has_ended_ = true;
  }
  changed_.notify_all();
}

/// False behind the last frame that is wanted.
bool LatestFrames::read_next(std::uint64_t index) {
  if (source_.frames >= 0 && index >= static_cast<std::uint64_t>(source_.frames)) return false;
  {
    const std::lock_guard lock(mutex_);
    if (is_stopped_) return false;
  }
  auto frame = source_.read(index);
  if (!frame || !wait_for(*frame)) return false;
  offer(*std::move(frame));
  return true;
}

/// Until the frame would have come from a camera; false when this was stopped.
bool LatestFrames::wait_for(const PipelineInput::Frame& frame) {
  constexpr double kLongest_s = 1e9;  // beyond that the clock's numbers end
  const auto time_s = source_.is_live ? std::nullopt : time_of(frame);
  if (!time_s) return true;
  const auto since_zero = std::chrono::duration_cast<Clock::Time::duration>(
      std::chrono::duration<double>(std::clamp(*time_s, -kLongest_s, kLongest_s)));
  if (!origin_) origin_ = clock_.now() - since_zero;
  return clock_.wait_until(*origin_ + since_zero, [this] {
    const std::lock_guard lock(mutex_);
    return is_stopped_;
  });
}

void LatestFrames::offer(PipelineInput::Frame frame) {
  std::optional<PipelineInput::Frame> dropped;
  {
    std::unique_lock lock(mutex_);
    // Reports frames that could not be read.
    const auto may_replace = [&] { return !newest_ || newest_->input.failure.empty(); };
    changed_.wait(lock, [&] { return is_stopped_ || may_replace(); });
    if (is_stopped_) return;
    dropped = std::exchange(newest_, std::nullopt);
    if (dropped) frame.input.dropped_before = dropped->input.dropped_before + 1;
    newest_.emplace(std::move(frame));
  }
  changed_.notify_all();
  if (dropped) source_.dropped(dropped->input.index);
}

}  // namespace weft
