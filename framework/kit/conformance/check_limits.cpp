// SPDX-License-Identifier: Apache-2.0
// Checks on the resources that a component takes and on the process state that it must preserve.
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <sstream>
#include <utility>

#include "host/records/shared_memory.hpp"
#include "kit/conformance/groups.hpp"
#include "kit/conformance/large_inputs.hpp"
#include "kit/conformance/probes/process_state.hpp"
#include "kit/conformance/probes/processor_time.hpp"

namespace weft::conformance {
namespace {

constexpr int kLeastCalls = 10, kMostCalls = 10'000, kRounds = 3, kInstances = 6;
constexpr std::chrono::duration<double> kCallingTime{2.0};  ///< CPU time
constexpr std::int64_t kMostGrowth = 1 << 20;               ///< [bytes] of the process
constexpr double kMostLeft = 128.0;                         ///< [bytes] of the heap, by a call

/// Separates stdout from stderr: check_in_child() writes both into one file.
void print_into_memory() {
  const int file = memfd_create("stdout", MFD_CLOEXEC);
  if (file < 0) return;
  dup2(file, STDOUT_FILENO);
  close(file);
}

/// The first line of a text that another one lacks; empty where it lacks none.
std::string line_beyond(const std::string& text, const std::string& other) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (("\n" + other + "\n").find("\n" + line + "\n") == std::string::npos) return line;
  }
  return "";
}

/// Looks at the state of the process that each function leaves, before the host restores it, and at
/// what it printed.
class StateWatch final : public testing::Passage {
 public:
  std::int32_t create(const weft_component& component, const weft_create& with, void** self,
                      weft_error* error) override {
    return seen("create", [&] { return Passage::create(component, with, self, error); });
  }
  std::int32_t prepare(const weft_component& component, void* self, const weft_call& call,
                       std::span<const weft_record> inputs, weft_error* error) override {
    return seen("prepare", [&] { return Passage::prepare(component, self, call, inputs, error); });
  }
  std::int32_t process(const weft_component& component, void* self, const weft_call& call,
                       std::span<const weft_record> inputs, weft_error* error) override {
    return seen("process", [&] { return Passage::process(component, self, call, inputs, error); });
  }
  void destroy(const weft_component& component, void* self) override {
    seen("destroy", [&] { return Passage::destroy(component, self), WEFT_OK; });
  }

  template <class Function>
  std::int32_t seen(const char* function, Function&& call) {
    const auto before = process_state();
    const std::int64_t printed = printed_bytes();
    const std::int32_t status = call();
    for (const auto& [part, now] : process_state()) {
      const std::string& then = before.at(part);
      if (now == then) continue;
      changes_.emplace(part, fmt::format("{} changes it, from '{}' to '{}'", function,
                                         line_beyond(then, now), line_beyond(now, then)));
    }
    if (printed_bytes() != printed) changes_.emplace("silent", std::string(function) + " prints");
    return status;
  }

  /// The first change of a part of the state, in words; empty if there is none.
  std::string change_of(const std::string& part) const {
    const auto found = changes_.find(part);
    return found != changes_.end() ? found->second : "";
  }

 private:
  std::map<std::string, std::string> changes_;
};

/// A component that was loaded, used and destroyed once, when that is first of interest.
class WatchedLife {
 public:
  explicit WatchedLife(const Setting& setting) : setting_(setting) {
    watch_.seen("loading",
                [&] { return host::load(*setting.candidate.installed()) ? WEFT_OK : WEFT_ERROR; });
  }
  std::string change_of(Play& play, const std::string& part) {
    if (!std::exchange(is_over_, true)) play.whole({.passage = &watch_});
    return watch_.change_of(part);
  }

 private:
  const Setting& setting_;
  StateWatch watch_;
  bool is_over_ = false;
};

void check_descriptors(Play& play, Page& page) {
  play.whole();  // files that a library opens once may stay open
  const std::size_t before = count_descriptors();
  for (int i = 0; i < kInstances; ++i) play.whole();
  const std::size_t after = count_descriptors();
  page.expect(after <= before, fmt::format("{} instances leave {} open files behind: close them "
                                           "in the destructor",
                                           kInstances, after - before));
}

void check_threads(Play& play, Page& page) {
  play.whole({.threads = 4});  // a pool of a library may stay
  const std::size_t before = count_threads();
  for (int i = 0; i < kInstances; ++i) play.whole({.threads = 4});
  const std::size_t after = count_threads();
  page.expect(after <= before, fmt::format("{} instances leave {} threads behind: end them in the "
                                           "destructor",
                                           kInstances, after - before));
}

void check_processes(Play& play, Page& page) {
  play.whole();
  siginfo_t info{};
  const bool has_child = waitid(P_ALL, 0, &info, WEXITED | WNOHANG | WNOWAIT) == 0;
  page.expect(
      !has_child,
      "it leaves a process behind: wait for what fork() starts, and end the copy by _exit()");
}

/// Calls for a while, each of the two frames as often, so that it ends as it began; how many were
/// made.
int call_for_a_while(Play& play, Performer& performer, double effort) {
  const Budget budget(effort * kCallingTime);
  int calls = 0;
  while (calls < kLeastCalls || calls % 2 != 0 || (calls < kMostCalls && !budget.is_over())) {
    play.frame(performer, static_cast<std::uint64_t>(calls++ % 2));
  }
  return calls;
}

/// A leak grows in each round; the memory of an allocator or a cache does not. Leaks of few calls
/// are too small for the figures of the process, but show in the heap.
void check_memory(Play& play, double effort, Page& page) {
  Performer performer(play.subject(), {.protects_inputs = false});
  if (!play.begin(performer).is_usable()) return;
  call_for_a_while(play, performer, effort);
  std::int64_t least = 1LL << 60;
  double least_left = 1e18;
  int calls = 0;
  for (int round = 0; round < kRounds && (least > kMostGrowth || least_left > kMostLeft); ++round) {
    const std::int64_t before = resident_bytes(), heap_before = heap_bytes();
    calls = call_for_a_while(play, performer, effort);
    least = std::min(least, resident_bytes() - before);
    least_left = std::min(least_left, static_cast<double>(heap_bytes() - heap_before) / calls);
  }
  const double mib = static_cast<double>(std::max<std::int64_t>(least, 0)) / (1 << 20);
  page.expect(least <= kMostGrowth,
              fmt::format("{} calls grow the process by {:.1f} MiB, time after time: free what a "
                          "call allocates",
                          calls, mib));
  page.expect(least_left <= kMostLeft,
              fmt::format("each call leaves {:.0f} bytes of the heap behind, time after time: free "
                          "what a call allocates",
                          least_left));
  page.note_count(calls, kMostCalls, fmt::format("calls, {:.2f} MiB", mib));
}

void check_opencv(Play& play, Page& page) {
  static_cast<void>(host::load(*play.subject().spec().installed));  // with what it brings
  const int before = opencv_threads();
  if (before < 0) return page.skip("it does not bring OpenCV");
  play.whole();
  page.expect(opencv_threads() == before,
              fmt::format("it changes the number of OpenCV's threads from {} to {}, also for "
                          "others: put it back",
                          before, opencv_threads()));
}

/// The C library's generator must continue as if only the program used it.
void check_generator(Play& play, Page& page) {
  constexpr unsigned kSeed = 7;
  std::srand(kSeed);
  const int expected = std::rand();
  std::srand(kSeed);
  play.whole();
  page.expect(std::rand() == expected,
              "it draws from rand() or seeds it: draw from weft_call.seed alone");
}

void check_seed(Play& play, Page& page) {
  if (play.subject().is_random()) {
    return page.skip("it, or a component that it contains, declares that it uses the seed");
  }
  const std::string how = difference(play.subject(), play.whole({.run_seed = 77}), play.whole());
  page.expect(how.empty(), "with another seed, " + how + "; declare random in kAbout");
}

void check_isolated(Play& play, Page& page) {
  auto arena = host::SharedArena::create();
  if (!arena) return page.skip(arena.error().message);
  const std::string how = difference(play.subject(), play.whole({.arena = *arena}), play.whole());
  page.expect(how.empty(), "in a separate process, " + how + " from its answer in this one");
}

}  // namespace

void check_limits(const Setting& setting, Notebook& notebook) {
  print_into_memory();
  WatchedLife life(setting);
  const auto made = Play::of(setting);
  if (!made) return;  // reported by the check of its parameters
  Play& play = **made;
  const auto state = [&](const char* what, const char* fix) {
    notebook.check(std::string("limits/") + what, [&](Page& page) {
      const std::string change = life.change_of(play, what);
      page.expect(change.empty(), change + ": " + fix);
    });
  };
  state("locale", "use functions that take a locale");
  state("floating_point", "put rounding back, and leave _mm_setcsr() alone");
  state("signals", "leave handlers and masks of signals to the program");
  state("working_directory", "use paths as they are given: they are absolute");
  state("umask", "give the permissions when you make a file");
  state("environment", "leave setenv() to the program");
  state("process", "leave limits, timers, processors, priority and handlers to the program");
  state("silent", "use weft_host.log, or stderr");
  const double effort = notebook.choice().effort;
  notebook.check("limits/opencv_threads", [&](Page& page) { check_opencv(play, page); });
  notebook.check("limits/generator", [&](Page& page) { check_generator(play, page); });
  notebook.check("limits/seed", [&](Page& page) { check_seed(play, page); });
  notebook.check("limits/descriptors", [&](Page& page) { check_descriptors(play, page); });
  notebook.check("limits/threads", [&](Page& page) { check_threads(play, page); });
  notebook.check("limits/processes", [&](Page& page) { check_processes(play, page); });
  notebook.check("limits/isolated", [&](Page& page) { check_isolated(play, page); });
  notebook.check("limits/memory", [&](Page& page) { check_memory(play, effort, page); });
  notebook.check("limits/large", [&](Page& page) { check_large(setting, effort, page); });
  notebook.check("limits/cancelled", [&](Page& page) { check_cancelled(setting, page); });
  notebook.check("limits/clock", [&](Page& page) {
    page.skip("a call of the clock cannot be observed; calls/repeated checks its effects");
  });
}

}  // namespace weft::conformance
