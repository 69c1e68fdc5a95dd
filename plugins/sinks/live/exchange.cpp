// SPDX-License-Identifier: Apache-2.0
#include "exchange.hpp"

#include <algorithm>
#include <iterator>
#include <string_view>
#include <utility>

namespace weft::live {
namespace {

constexpr std::size_t kMostLines = 256, kMostWishes = 64;
/// Wishes that the run has taken and not answered: it keeps each until it is made.
constexpr std::size_t kMostAskers = 256;

/// Whether the run stands still once the wish is granted; absent where that stays as it was.
std::optional<bool> pauses(std::string_view wish) {
  if (wish == "pause" || wish == "step") return true;
  if (wish == "resume") return false;
  return std::nullopt;
}

}  // namespace

void Exchange::wake() {
  if (is_woken_ || !wake_) return;
  wake_();
  is_woken_ = true;  // not where that threw: the next one wakes
}

void Exchange::put_frame(FrameCopy frame) {
  const std::lock_guard lock(mutex_);
  arrivals_.frame = std::move(frame);
  is_shown_ = true;
  wake();
}

void Exchange::pass_frame() {
  const std::lock_guard lock(mutex_);
  if (!is_shown_) return;
  is_shown_ = false;
  arrivals_.frame.reset();
  arrivals_.is_passed = true;
  wake();
}

void Exchange::put_line(std::string line) {
  std::replace(line.begin(), line.end(), '\n', ' ');
  line += '\n';
  const std::lock_guard lock(mutex_);
  if (arrivals_.lines.size() == kMostLines) arrivals_.lines.pop_front();
  arrivals_.lines.push_back(std::move(line));
  wake();
}

void Exchange::put_settings(std::string settings) {
  const std::lock_guard lock(mutex_);
  arrivals_.settings = std::move(settings);
  wake();
}

std::vector<Wish> Exchange::take_wishes() {
  const std::lock_guard lock(mutex_);
  if (is_abandoned_) add_wish(kServer, 0, "resume");  // whether or not there is room for more
  std::vector<Wish> taken(std::make_move_iterator(wishes_.begin()),
                          std::make_move_iterator(wishes_.end()));
  wishes_.clear();
  return taken;
}

void Exchange::answer(const WishAnswer& answer) {
  const std::lock_guard lock(mutex_);
  const auto asker = askers_.find(answer.number);
  if (asker == askers_.end()) return;
  const auto& [client, number, pauses] = asker->second;
  arrivals_.answers.push_back({client, number, answer.frame, answer.refusal,
                               answer.refusal.empty() ? pauses : std::nullopt});
  askers_.erase(asker);
  wake();
}

void Exchange::attach(std::function<void()> wake) {
  const std::lock_guard lock(mutex_);
  wake_ = std::move(wake);
  is_woken_ = false;
}

void Exchange::detach() { attach(nullptr); }

Arrivals Exchange::take() {
  const std::lock_guard lock(mutex_);
  is_woken_ = false;
  return std::exchange(arrivals_, {});
}

std::string Exchange::ask(ClientId client, std::uint64_t number, std::string text) {
  const std::lock_guard lock(mutex_);
  if (wishes_.size() == kMostWishes) {
    return "64 wishes wait already: the run takes them before each frame, so wish again then";
  }
  if (askers_.size() == kMostAskers) {
    return "256 wishes have no answer yet: the run makes one after the other, so wish again then";
  }
  add_wish(client, number, std::move(text));
  return {};
}

void Exchange::add_wish(ClientId client, std::uint64_t number, std::string text) {
  const std::optional<bool> paused = pauses(text);
  if (paused == true) pausing_.insert(client);
  if (paused == false) pausing_.clear();
  if (paused) is_abandoned_ = false;
  askers_[++asked_] = {client, number, paused};
  wishes_.push_back({asked_, std::move(text)});
}

void Exchange::leave(ClientId client) noexcept {
  const std::lock_guard lock(mutex_);
  if (pausing_.erase(client) > 0 && pausing_.empty()) is_abandoned_ = true;
}

}  // namespace weft::live
