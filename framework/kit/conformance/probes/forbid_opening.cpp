// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <ucontext.h>

#include <array>
#include <bit>
#include <cerrno>
#include <csignal>
#include <cstddef>
#include <cstring>

#include "kit/conformance/probes/process_state.hpp"

namespace weft::conformance {
namespace {

// Data for a signal handler.
std::array<char, 256> first_path{};
volatile std::sig_atomic_t is_forbidden = 0;

constexpr std::array kOpening = {
#ifdef SYS_open
    SYS_open,
    SYS_creat,
#endif
    SYS_openat,
    SYS_openat2,
};

#if defined(__x86_64__) || defined(__aarch64__)

/// Answers a call that opens a file: it is not permitted.
void on_opening(int /*signal*/, siginfo_t* info, void* given) {
  auto* context = static_cast<ucontext_t*>(given);
#if defined(__x86_64__)
  auto* registers = context->uc_mcontext.gregs;
  const bool has_folder = info->si_syscall == SYS_openat || info->si_syscall == SYS_openat2;
  const auto path = registers[has_folder ? REG_RSI : REG_RDI];
  registers[REG_RAX] = -EACCES;
#else
  const auto path = context->uc_mcontext.regs[1];
  context->uc_mcontext.regs[0] = static_cast<unsigned long long>(-EACCES);
#endif
  if (is_forbidden != 0) return;
  is_forbidden = 1;
  std::strncpy(first_path.data(), std::bit_cast<const char*>(path), first_path.size() - 1);
}

bool can_answer() { return true; }

#else

void on_opening(int, siginfo_t*, void*) {}
bool can_answer() { return false; }

#endif

}  // namespace

bool forbid_opening() {
  if (!can_answer()) return false;
  struct sigaction action {};
  action.sa_sigaction = on_opening;
  action.sa_flags = SA_SIGINFO;
  sigaction(SIGSYS, &action, nullptr);
  std::array<sock_filter, 2 * kOpening.size() + 2> rules{};
  std::size_t count = 0;
  rules[count++] = BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr));
  for (const auto number : kOpening) {
    rules[count++] = BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, static_cast<std::uint32_t>(number), 0, 1);
    rules[count++] = BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_TRAP);
  }
  rules[count++] = BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW);
  const sock_fprog program{static_cast<unsigned short>(count), rules.data()};
  return prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 &&
         prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) == 0;
}

std::string forbidden_opening() { return is_forbidden != 0 ? first_path.data() : ""; }

}  // namespace weft::conformance
