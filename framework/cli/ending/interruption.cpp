// SPDX-License-Identifier: Apache-2.0
#include "cli/ending/interruption.hpp"

#include <fmt/format.h>

#include <csignal>

#include "cli/ending/running_calls.hpp"
#include "cli/ending/sudden_end.hpp"
#include "host/calling/execution_context.hpp"

namespace weft::cli {
namespace {

// A signal handler can access only objects with static storage.
std::atomic<bool> signal_came{false};

static_assert(std::atomic<bool>::is_always_lock_free);

/// Calls nothing but what POSIX allows in a signal handler.
void on_signal(int signal) {
  if (!signal_came.exchange(true)) return;
  say("\ninterrupted twice, ended at once; running: ");
  static bool is_first = true;
  const int calls = visit_running_calls([](const RunningCall& call) {
    if (!is_first) say("; ");
    is_first = false;
    say(call.bytes.data(), call.length);
  });
  say(calls == 0 ? "nothing of a pipeline\n" : "\n");
  end_at_once(128 + signal);
}

}  // namespace

const std::atomic<bool>& watch_for_interruption() {
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
  return signal_came;
}

void now_running(const std::string& what) {
  watch_stack_here();
  set_running(what, false);
}

void now_running(const std::string& stage, const std::string& component, const std::string& what,
                 std::uint64_t frame) {
  watch_stack_here();
  set_running(frame == host::kOfflineFrame
                  ? fmt::format("{} ({}: {}), outside of the frames", stage, component, what)
                  : fmt::format("{} ({}: {}), frame {}", stage, component, what, frame),
              true);
}

host::ComponentChecks checks_of(const std::string& file) {
  now_running("the checks of " + file);
  return host::ComponentChecks(
      [file](const std::string& id) { now_running(id + ", called by the checks of " + file); });
}

}  // namespace weft::cli
