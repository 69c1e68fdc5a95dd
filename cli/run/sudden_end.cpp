// SPDX-License-Identifier: Apache-2.0
#include "cli/run/sudden_end.hpp"

#include <dlfcn.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>

#include "cli/commands.hpp"

namespace weft::cli {
namespace {

struct Deadly {
  int signal;
  const char* meaning;
};
constexpr std::array<Deadly, 5> kDeadly{{{SIGSEGV, "SIGSEGV, memory that is not its own"},
                                         {SIGBUS, "SIGBUS, memory that is not there"},
                                         {SIGFPE, "SIGFPE, a division by zero"},
                                         {SIGILL, "SIGILL, an instruction that there is not"},
                                         {SIGABRT, "SIGABRT, a failed check or an exception"}}};

struct Text {
  std::array<char, 320> bytes;
  std::size_t length;
};

// Handlers reach nothing but objects with static storage.
thread_local Text here{};
Text anywhere{};
std::atomic<bool> is_watching{false};
std::array<struct sigaction, kDeadly.size()> before;

static_assert(std::atomic<bool>::is_always_lock_free);

/// For a handler that runs when the stack of its thread is full.
class AlternateStack {
 public:
  AlternateStack() {
    stack_t known{};
    if (sigaltstack(nullptr, &known) != 0 || (known.ss_flags & SS_DISABLE) == 0) return;
    memory_ = std::make_unique<char[]>(kSize);
    stack_t own{};
    own.ss_sp = memory_.get();
    own.ss_size = kSize;
    if (sigaltstack(&own, nullptr) != 0) memory_.reset();
  }
  ~AlternateStack() {
    if (memory_ == nullptr) return;
    stack_t none{};
    none.ss_flags = SS_DISABLE;
    sigaltstack(&none, nullptr);
  }
  AlternateStack(const AlternateStack&) = delete;
  AlternateStack& operator=(const AlternateStack&) = delete;

 private:
  static constexpr std::size_t kSize = 65536;
  std::unique_ptr<char[]> memory_;
};

// From here on nothing is called but what POSIX allows in a signal handler.

void say(const char* text, std::size_t length) {
  static_cast<void>(!write(STDERR_FILENO, text, length));
}
void say(const char* text) { say(text, std::strlen(text)); }

void say_what_ran() {
  const Text& known = here.length > 0 ? here : anywhere;
  say("\n");
  say(known.bytes.data(), known.length);
}

void on_deadly(int signal, siginfo_t* info, void*) {
  for (std::size_t i = 0; i < kDeadly.size(); ++i) {
    sigaction(kDeadly[i].signal, &before[i], nullptr);
    if (kDeadly[i].signal != signal) continue;
    say_what_ran();
    say(": ended the process (");
    say(kDeadly[i].meaning);
    say("); frames in the run folder stay. Try isolate: process at its stage: this then costs one "
        "frame\n");
  }
  // A fault comes again by itself; what was sent does not.
  if (info->si_code <= 0) raise(signal);
}

/// Whoever called exit() was not us.
void on_exit_of_component() {
  if (!is_watching) return;
  say_what_ran();
  say(": called exit(); frames in the run folder stay. Try isolate: process at its stage: this "
      "then costs one frame\n");
  _exit(kComponentExited);
}

}  // namespace

SuddenEndWatch::SuddenEndWatch() {
  static const bool is_registered = std::at_quick_exit(on_exit_of_component) == 0;
  is_watching = is_registered;
  struct sigaction action {};
  action.sa_sigaction = on_deadly;
  action.sa_flags = SA_SIGINFO | SA_ONSTACK;
  sigemptyset(&action.sa_mask);
  for (std::size_t i = 0; i < kDeadly.size(); ++i) {
    sigaction(kDeadly[i].signal, &action, &before[i]);
  }
}

SuddenEndWatch::~SuddenEndWatch() {
  is_watching = false;
  for (std::size_t i = 0; i < kDeadly.size(); ++i) {
    sigaction(kDeadly[i].signal, &before[i], nullptr);
  }
}

void now_running_here(const std::string& what) {
  thread_local const AlternateStack stack;
  for (Text* text : {&here, &anywhere}) {
    text->length = std::min(what.size(), text->bytes.size());
    std::copy_n(what.begin(), text->length, text->bytes.begin());
  }
}

}  // namespace weft::cli

/// Stands before the C library's for all that the process loads: that one destroys what other
/// threads still use, and what they do then would be told in place of the call. The return from
/// main() does not pass here.
extern "C" [[gnu::noreturn]] void exit(int code) noexcept {
  weft::cli::on_exit_of_component();
  using Exit = void (*)(int);
  const auto next = reinterpret_cast<Exit>(dlsym(RTLD_NEXT, "exit"));
  if (next != nullptr) next(code);
  _exit(code);
}
