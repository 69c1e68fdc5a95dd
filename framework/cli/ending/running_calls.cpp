// SPDX-License-Identifier: Apache-2.0
#include "cli/ending/running_calls.hpp"

#include <algorithm>
#include <atomic>

namespace weft::cli {
namespace {

/// One thread's. A new action is written into the text that is not shown, which is then shown.
struct Slot {
  std::atomic<bool> taken{false};
  std::atomic<bool> running{false};
  std::atomic<const RunningCall*> shown{nullptr};
  std::array<RunningCall, 2> texts{};
};

// A signal handler can access only objects with static storage.
std::array<Slot, 64> slots_of_threads{};
std::atomic<const RunningCall*> last_set{nullptr};

static_assert(std::atomic<bool>::is_always_lock_free &&
              std::atomic<const RunningCall*>::is_always_lock_free);

/// The slot of a thread, until it ends.
class Place {
 public:
  Place() {
    for (Slot& slot : slots_of_threads) {
      if (slot.taken.exchange(true)) continue;
      slot_ = &slot;
      return;
    }
  }
  ~Place() {
    if (slot_ == nullptr) return;
    slot_->running = false;
    slot_->taken = false;
  }
  Place(const Place&) = delete;
  Place& operator=(const Place&) = delete;

  Slot* slot() const { return slot_; }

 private:
  Slot* slot_ = nullptr;
};

Slot* slot_here() {
  thread_local const Place place;
  return place.slot();
}

// A handler cannot make the place of a thread, so this is set when it is made.
thread_local Slot* made_here = nullptr;

}  // namespace

void set_running(const std::string& what, bool of_run) {
  Slot* const slot = made_here = slot_here();
  if (slot == nullptr) return;
  RunningCall& call = slot->texts[slot->shown.load() == &slot->texts[0] ? 1 : 0];
  call.length = std::min(what.size(), call.bytes.size());
  std::copy_n(what.begin(), call.length, call.bytes.begin());
  call.of_run = of_run;
  slot->shown = &call;
  slot->running = true;
  last_set = &call;
}

void set_ended() {
  if (made_here != nullptr) made_here->running = false;
}

const RunningCall* last_call_here() {
  return made_here == nullptr ? nullptr : made_here->shown.load();
}

const RunningCall* last_call_anywhere() { return last_set; }

int visit_running_calls(void (*visit)(const RunningCall&)) {
  int visited = 0;
  for (const Slot& slot : slots_of_threads) {
    if (!slot.running) continue;
    visit(*slot.shown.load());
    ++visited;
  }
  return visited;
}

}  // namespace weft::cli
