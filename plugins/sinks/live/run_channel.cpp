// SPDX-License-Identifier: Apache-2.0
#include "run_channel.hpp"

#include <algorithm>
#include <iterator>
#include <string_view>
#include <utility>

namespace weft::live {
namespace {

constexpr std::size_t kMostLines = 256, kMostRequests = 64;
/// Requests that the run has taken and not answered: it keeps each until it is made.
constexpr std::size_t kMostAskers = 256;

/// True if the run pauses once the change request is granted, false if it resumes; absent where the
/// request changes neither.
std::optional<bool> pauses(std::string_view request) {
  if (request == "pause" || request == "step") return true;
  if (request == "resume") return false;
  return std::nullopt;
}

}  // namespace

void RunChannel::wake() {
  if (is_woken_ || !wake_) return;
  wake_();
  is_woken_ = true;  // not where that threw: the next one wakes
}

void RunChannel::put_frame(FrameCopy frame) {
  const std::lock_guard lock(mutex_);
  arrivals_.frame = std::move(frame);
  is_shown_ = true;
  wake();
}

void RunChannel::pass_frame() {
  const std::lock_guard lock(mutex_);
  if (!is_shown_) return;
  is_shown_ = false;
  arrivals_.frame.reset();
  arrivals_.is_passed = true;
  wake();
}

void RunChannel::put_line(std::string line) {
  std::replace(line.begin(), line.end(), '\n', ' ');
  line += '\n';
  const std::lock_guard lock(mutex_);
  if (arrivals_.lines.size() == kMostLines) arrivals_.lines.pop_front();
  arrivals_.lines.push_back(std::move(line));
  wake();
}

void RunChannel::put_settings(std::string settings) {
  const std::lock_guard lock(mutex_);
  arrivals_.settings = std::move(settings);
  wake();
}

void RunChannel::put_calibration(std::string state) {
  const std::lock_guard lock(mutex_);
  arrivals_.calibration = std::move(state);
  wake();
}

std::vector<ChangeRequest> RunChannel::take_change_requests() {
  const std::lock_guard lock(mutex_);
  if (is_abandoned_) add_request(kServer, 0, "resume");  // even if there is no room for more
  std::vector<ChangeRequest> taken(std::make_move_iterator(requests_.begin()),
                                   std::make_move_iterator(requests_.end()));
  requests_.clear();
  return taken;
}

void RunChannel::answer(const ChangeAnswer& answer) {
  const std::lock_guard lock(mutex_);
  const auto asker = askers_.find(answer.number);
  if (asker == askers_.end()) return;
  const auto& [client, number, pauses] = asker->second;
  arrivals_.answers.push_back({client, number, answer.frame, answer.refusal,
                               answer.refusal.empty() ? pauses : std::nullopt});
  askers_.erase(asker);
  wake();
}

void RunChannel::attach(std::function<void()> wake) {
  const std::lock_guard lock(mutex_);
  wake_ = std::move(wake);
  is_woken_ = false;
}

void RunChannel::detach() { attach(nullptr); }

Arrivals RunChannel::take() {
  const std::lock_guard lock(mutex_);
  is_woken_ = false;
  return std::exchange(arrivals_, {});
}

std::string RunChannel::ask(ClientId client, std::uint64_t number, std::string text) {
  const std::lock_guard lock(mutex_);
  if (requests_.size() == kMostRequests) {
    return "64 change requests wait already: the run takes them before each frame, so send again "
           "then";
  }
  if (askers_.size() == kMostAskers) {
    return "256 change requests have no answer yet: the run makes one after the other, so send "
           "again then";
  }
  add_request(client, number, std::move(text));
  return {};
}

void RunChannel::add_request(ClientId client, std::uint64_t number, std::string text) {
  const std::optional<bool> paused = pauses(text);
  if (paused == true) pausing_.insert(client);
  if (paused == false) pausing_.clear();
  if (paused) is_abandoned_ = false;
  askers_[++asked_] = {client, number, paused};
  requests_.push_back({asked_, std::move(text)});
}

void RunChannel::leave(ClientId client) noexcept {
  const std::lock_guard lock(mutex_);
  if (pausing_.erase(client) > 0 && pausing_.empty()) is_abandoned_ = true;
}

}  // namespace weft::live
