// SPDX-License-Identifier: Apache-2.0
// Checks on the resources that a component takes and on the process state that it must preserve.
#include <fmt/format.h>

#include <cstdlib>
#include <sstream>

#include "host/records/shared_memory.hpp"
#include "kit/conformance/groups.hpp"
#include "kit/conformance/large_inputs.hpp"
#include "kit/conformance/probes/process_state.hpp"

namespace weft::conformance {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kLeastCalls = 10, kMostCalls = 10'000, kRounds = 3, kInstances = 6;
constexpr std::chrono::seconds kCallingTime{2};
constexpr std::int64_t kMostGrowth = 1 << 20;  ///< [bytes] of the process
constexpr double kMostLeft = 128.0;            ///< [bytes] of the heap, by a call

/// The first line of a text that another one lacks; empty where it lacks none.
std::string line_beyond(const std::string& text, const std::string& other) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (("\n" + other + "\n").find("\n" + line + "\n") == std::string::npos) return line;
  }
  return "";
}

/// The state of the process before and after a component was loaded, used and destroyed.
void check_state(Usual& usual, const std::map<std::string, std::string>& before, const char* what,
                 const char* fix, Page& page) {
  usual.answers();
  const std::string now = process_state().at(what), &then = before.at(what);
  page.expect(now == then, fmt::format("it changes it, from '{}' to '{}': {}",
                                       line_beyond(then, now), line_beyond(now, then), fix));
}

/// Looks at the mode that a component leaves, before the host sets it back.
class ModeWatch final : public testing::Passage {
 public:
  std::int32_t create(const weft_component& component, const weft_create& with, void** self,
                      weft_error* error) override {
    return seen("create", Passage::create(component, with, self, error));
  }
  std::int32_t prepare(const weft_component& component, void* self, const weft_call& call,
                       std::span<const weft_record> inputs, weft_error* error) override {
    return seen("prepare", Passage::prepare(component, self, call, inputs, error));
  }
  std::int32_t process(const weft_component& component, void* self, const weft_call& call,
                       std::span<const weft_record> inputs, weft_error* error) override {
    return seen("process", Passage::process(component, self, call, inputs, error));
  }
  /// The first function that left another one; empty where none did.
  const std::string& culprit() const { return culprit_; }

 private:
  std::int32_t seen(const char* function, std::int32_t status) {
    if (culprit_.empty() && floating_point_mode() != before_) culprit_ = function;
    return status;
  }

  std::string before_ = floating_point_mode(), culprit_;
};

void check_floating_point(Play& play, Page& page) {
  ModeWatch watch;
  play.whole({.passage = &watch});
  page.expect(watch.culprit().empty(),
              watch.culprit() + " changes it: put rounding back, and leave _mm_setcsr() alone");
}

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
  page.expect(after <= before, fmt::format("{} instances leave {} threads behind: end them before "
                                           "the call returns",
                                           kInstances, after - before));
}

/// Calls for a while, each of the two frames as often, so that it ends as it began; how many were
/// made.
int call_for_a_while(Play& play, Performer& performer) {
  const auto end = Clock::now() + kCallingTime;
  int calls = 0;
  while (calls < kLeastCalls || calls % 2 != 0 || (calls < kMostCalls && Clock::now() < end)) {
    play.frame(performer, static_cast<std::uint64_t>(calls++ % 2));
  }
  return calls;
}

/// A leak grows in each round; the memory of an allocator or a cache does not. Leaks of few calls
/// are too small for the figures of the process, but show in the heap.
void check_memory(Play& play, Page& page) {
  Performer performer(play.subject(), {.protects_inputs = false});
  if (!play.begin(performer).is_usable()) return;
  call_for_a_while(play, performer);
  std::int64_t least = 1LL << 60;
  double least_left = 1e18;
  int calls = 0;
  for (int round = 0; round < kRounds && (least > kMostGrowth || least_left > kMostLeft); ++round) {
    const std::int64_t before = resident_bytes(), heap_before = heap_bytes();
    calls = call_for_a_while(play, performer);
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
  page.note(fmt::format("{} calls, {:.2f} MiB", calls, mib));
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
  const auto before = process_state();
  const auto made = Play::of(setting);
  if (!made) return;  // reported by the check of its parameters
  Play& play = **made;
  Usual usual(play);
  const auto state = [&](const char* what, const char* fix) {
    notebook.check(std::string("limits/") + what,
                   [&](Page& page) { check_state(usual, before, what, fix, page); });
  };
  state("locale", "use functions that take a locale");
  notebook.check("limits/floating_point", [&](Page& page) { check_floating_point(play, page); });
  state("signals", "leave handlers and masks of signals to the program");
  state("working_directory", "use paths as they are given: they are absolute");
  state("umask", "give the permissions when you make a file");
  state("environment", "leave setenv() to the program");
  notebook.check("limits/opencv_threads", [&](Page& page) { check_opencv(play, page); });
  notebook.check("limits/generator", [&](Page& page) { check_generator(play, page); });
  notebook.check("limits/seed", [&](Page& page) { check_seed(play, page); });
  notebook.check("limits/descriptors", [&](Page& page) { check_descriptors(play, page); });
  notebook.check("limits/threads", [&](Page& page) { check_threads(play, page); });
  notebook.check("limits/isolated", [&](Page& page) { check_isolated(play, page); });
  notebook.check("limits/memory", [&](Page& page) { check_memory(play, page); });
  notebook.check("limits/large", [&](Page& page) { check_large(setting, page); });
  notebook.check("limits/cancelled", [&](Page& page) { check_cancelled(setting, page); });
  notebook.check("limits/clock", [&](Page& page) {
    page.skip("a call of the clock cannot be observed; calls/repeated checks its effects");
  });
}

}  // namespace weft::conformance
