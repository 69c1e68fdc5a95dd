// SPDX-License-Identifier: Apache-2.0
#include "cli/ending/sudden_end.hpp"

#include <dlfcn.h>
#include <signal.h>
#include <sys/syscall.h>
#include <ucontext.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>

#include "cli/ending/running_calls.hpp"
#include "cli/output/outcome.hpp"
#include "host/calling/protected_inputs.hpp"
#include "host/guarding/loaded_code.hpp"

namespace weft::cli {
namespace {

struct Deadly {
  int signal;
  const char* meaning;
};
constexpr std::array<Deadly, 5> kDeadly{{{SIGSEGV, " (SIGSEGV, memory that is not its own)"},
                                         {SIGBUS, " (SIGBUS, memory that is not there)"},
                                         {SIGFPE, " (SIGFPE, a division by zero)"},
                                         {SIGILL, " (SIGILL, an instruction that there is not)"},
                                         {SIGABRT, " (SIGABRT, a failed check or an exception)"}}};

// Handlers reach nothing but objects with static storage.
std::atomic<pid_t> watched{0};  ///< the process; a copy of it may end as it likes
std::array<struct sigaction, kDeadly.size()> actions_before;

static_assert(std::atomic<pid_t>::is_always_lock_free);

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

/// Where a thread is: its instruction, and the top of its stack.
struct ThreadPlace {
  std::uintptr_t instruction, stack_top;
};

ThreadPlace place_in(const void* context) {
  const mcontext_t& registers = static_cast<const ucontext_t*>(context)->uc_mcontext;
#if defined(__x86_64__)
  return {static_cast<std::uintptr_t>(registers.gregs[REG_RIP]),
          static_cast<std::uintptr_t>(registers.gregs[REG_RSP])};
#elif defined(__aarch64__)
  return {registers.pc, registers.sp};
#else
  return {0, 0};
#endif
}

/// Prints what ran, and how it ended.
void say_what_ran(const ThreadPlace& place, const char* how, const char* more) {
  const RunningCall* const here = last_call_here();
  const RunningCall* const known = here != nullptr ? here : last_call_anywhere();
  const char* const library =
      here == nullptr ? host::library_that_runs(place.instruction, place.stack_top) : nullptr;
  say("\n");
  if (library != nullptr) {
    say(library);
    say(", in a thread that it started");
  } else if (here == nullptr) {
    say(known != nullptr ? "in a thread of a component" : "weft");
  }
  // With several frames at once, the last call need not be that of the thread's component.
  if (here == nullptr && known != nullptr) say(", after the call ");
  if (known != nullptr) say(known->bytes.data(), known->length);
  say(": ");
  say(how);
  say(more);
  say(known != nullptr && known->of_run
          ? "; frames in the run folder stay. Try isolate: process at its stage: this then "
            "costs one frame\n"
          : "\n");
}

void on_deadly(int signal, siginfo_t* info, void* context) {
  const ThreadPlace thread = place_in(context);
  const host::ProtectedPlace place =
      signal == SIGSEGV ? host::protected_place(info->si_addr) : host::ProtectedPlace{};
  for (std::size_t i = 0; i < kDeadly.size(); ++i) {
    sigaction(kDeadly[i].signal, &actions_before[i], nullptr);
    if (kDeadly[i].signal != signal || watched != getpid()) continue;
    if (place.input == nullptr) say_what_ran(thread, "ended the process", kDeadly[i].meaning);
    if (place.input != nullptr) {
      say_what_ran(thread,
                   place.beyond ? "went beyond the end of its input " : "wrote into its input ",
                   place.input);
    }
  }
  // A fault comes again by itself; what was sent does not.
  if (info->si_code <= 0) raise(signal);
}

/// Handles a call that did not come from this program.
void on_exit_of_component(const char* function) {
  if (watched != getpid()) return;
  const auto stack_top = reinterpret_cast<std::uintptr_t>(__builtin_frame_address(0));
  say_what_ran({0, stack_top}, "called ", function);
  end_at_once(kComponentExited);
}

}  // namespace

SuddenEndWatch::SuddenEndWatch() {
  static const bool is_registered =
      std::at_quick_exit([] { on_exit_of_component("quick_exit()"); }) == 0;
  watched = is_registered ? getpid() : 0;
  struct sigaction action {};
  action.sa_sigaction = on_deadly;
  action.sa_flags = SA_SIGINFO | SA_ONSTACK;
  sigemptyset(&action.sa_mask);
  for (std::size_t i = 0; i < kDeadly.size(); ++i) {
    sigaction(kDeadly[i].signal, &action, &actions_before[i]);
  }
}

SuddenEndWatch::~SuddenEndWatch() {
  watched = 0;
  for (std::size_t i = 0; i < kDeadly.size(); ++i) {
    sigaction(kDeadly[i].signal, &actions_before[i], nullptr);
  }
}

void watch_stack_here() { thread_local const AlternateStack stack; }

void say(const char* text, std::size_t length) {
  static_cast<void>(!write(STDERR_FILENO, text, length));
}

void say(const char* text) { say(text, std::strlen(text)); }

void end_at_once(int code) {
  while (true) syscall(SYS_exit_group, code);
}

}  // namespace weft::cli

// These functions override those of the C library for all libraries of the process. The return from
// main() does not call them.

/// The C library's exit() destroys objects that other threads still use, and the resulting errors
/// would be reported instead of this call.
extern "C" [[gnu::noreturn]] void exit(int code) noexcept {
  weft::cli::on_exit_of_component("exit()");
  using Exit = void (*)(int);
  const auto next = reinterpret_cast<Exit>(dlsym(RTLD_NEXT, "exit"));
  if (next != nullptr) next(code);
  weft::cli::end_at_once(code);
}

// NOLINTBEGIN(bugprone-reserved-identifier): so they are called
extern "C" [[gnu::noreturn]] void _exit(int code) {
  weft::cli::on_exit_of_component("_exit()");
  weft::cli::end_at_once(code);
}

extern "C" [[gnu::noreturn]] void _Exit(int code) noexcept {
  weft::cli::on_exit_of_component("_Exit()");
  weft::cli::end_at_once(code);
}
// NOLINTEND(bugprone-reserved-identifier)
