// SPDX-License-Identifier: Apache-2.0
#include "pipeline/execution/frame_line.hpp"

#include <algorithm>
#include <thread>

namespace weft {

FrameLine::FrameLine(std::vector<StepRule> rules, std::size_t settled, std::size_t frames_at_once)
    : rules_(std::move(rules)),
      settled_(settled),
      frames_at_once_(std::max<std::size_t>(frames_at_once, 1)) {}

void FrameLine::run(int threads, const Work& work) {
  {
    std::vector<std::jthread> others;
    for (int i = 1; i < threads; ++i) others.emplace_back([&] { travel(work); });
    travel(work);
  }
  if (failure_) std::rethrow_exception(failure_);
}

void FrameLine::travel(const Work& work) {
  std::unique_lock lock(mutex_);
  for (;;) {
    const auto turn = next_turn();
    if (!turn) {
      if (travellers_.empty()) return;  // and none may enter, or there would be a turn
      changed_.wait(lock);
      continue;
    }
    lock.unlock();
    Answer answer = Answer::last;
    std::exception_ptr failure;
    try {
      answer = work(turn->step, turn->frame);
    } catch (...) {
      failure = std::current_exception();
    }
    lock.lock();
    if (failure && turn->frame < failed_frame_) {
      failure_ = failure;
      failed_frame_ = turn->frame;
      drop_from(turn->frame);
    }
    note(*turn, answer);
    changed_.notify_all();
  }
}

/// The earliest frame that can go on, or the next one to enter. Its traveller is busy from now on.
std::optional<FrameLine::Turn> FrameLine::next_turn() {
  for (std::size_t i = 0; i < travellers_.size() && first_ + i < end_; ++i) {
    Traveller& traveller = travellers_[i];
    const std::uint64_t frame = first_ + i;
    if (traveller.is_busy || !may_go(frame, traveller.passed)) continue;
    traveller.is_busy = true;
    return Turn{traveller.passed, frame};
  }
  const std::uint64_t frame = first_ + travellers_.size();
  if (travellers_.size() == frames_at_once_ || frame >= end_ || !may_go(frame, 0)) return {};
  travellers_.push_back({0, true});
  return Turn{0, frame};
}

bool FrameLine::may_go(std::uint64_t frame, std::size_t step) const {
  const StepRule& rule = rules_[step];
  if (frame > 0 && !has_passed(frame - 1, step + rule.busy_for)) return false;
  const auto back = static_cast<std::uint64_t>(rule.frames_back);
  return back == 0 || frame < back || has_passed(frame - back, settled_);
}

bool FrameLine::has_passed(std::uint64_t frame, std::size_t step) const {
  return frame < first_ || travellers_[frame - first_].passed > step;
}

void FrameLine::note(const Turn& turn, Answer answer) {
  Traveller& traveller = travellers_[turn.frame - first_];
  traveller.is_busy = false;
  ++traveller.passed;
  if (answer == Answer::not_there) drop_from(turn.frame);
  if (answer == Answer::last) drop_from(turn.frame + 1);
  retire();
}

/// No frame from here on is wanted; those whose step still runs are dropped when it is over.
void FrameLine::drop_from(std::uint64_t frame) { end_ = std::min(end_, frame); }

/// Takes away the frames that are through, and those behind the end that no thread works on.
void FrameLine::retire() {
  while (!travellers_.empty() && travellers_.front().passed == rules_.size()) {
    travellers_.pop_front();
    ++first_;
  }
  while (!travellers_.empty() && first_ + travellers_.size() > end_ &&
         !travellers_.back().is_busy) {
    travellers_.pop_back();
  }
}

}  // namespace weft
