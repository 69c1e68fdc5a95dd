// SPDX-License-Identifier: Apache-2.0
#include "cli/run/interruption.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstring>

#include "cli/run/sudden_end.hpp"
#include "host/calling/execution_context.hpp"

namespace weft::cli {
namespace {

struct Line {
  std::array<char, 320> text;
  std::size_t length;
};

// A signal handler can access only objects with static storage. The running component is written
// into the line that is not shown, which is then shown.
std::atomic<bool> signal_came{false};
std::array<Line, 2> lines_of_stages{};
std::atomic<std::size_t> current{0};

static_assert(std::atomic<bool>::is_always_lock_free &&
              std::atomic<std::size_t>::is_always_lock_free);

/// Calls nothing but what POSIX allows in a signal handler.
void on_signal(int signal) {
  if (!signal_came.exchange(true)) return;
  const Line& line = lines_of_stages[current.load()];
  static_cast<void>(!write(STDERR_FILENO, line.text.data(), line.length));
  end_at_once(128 + signal);
}

/// On a signal or an error, the code that ends the process prints what ran.
void tell(const std::string& what, bool of_run) {
  now_running_here(what, of_run);
  const std::size_t next = 1 - current.load();
  Line& line = lines_of_stages[next];
  const std::string text = "\ninterrupted twice, ended at once; running: ";
  const std::size_t room = line.text.size() - text.size() - 1;
  const std::string whole = text + what.substr(0, room) + "\n";
  std::copy(whole.begin(), whole.end(), line.text.begin());
  line.length = whole.size();
  current.store(next);
}

}  // namespace

const std::atomic<bool>& watch_for_interruption() {
  if (lines_of_stages[current.load()].length == 0) now_running("nothing of a pipeline");
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
  return signal_came;
}

void now_running(const std::string& what) { tell(what, false); }

void now_running(const std::string& stage, const std::string& component, const std::string& what,
                 std::uint64_t frame) {
  tell(frame == host::kOfflineFrame
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
