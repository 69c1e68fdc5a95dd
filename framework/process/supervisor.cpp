// SPDX-License-Identifier: Apache-2.0
#include "process/supervisor.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sched.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>

#include "process/descendants.hpp"

namespace weft::process {
namespace {

using Clock = std::chrono::steady_clock;

constexpr const char* kName = "weft-supervisor";
constexpr std::chrono::milliseconds kTick{25}, kTickOfFlood{2};
constexpr std::chrono::seconds kPatience{30};  ///< with processes that the kernel does not end
constexpr off_t kMostOutput_bytes = 1 << 20;   ///< before its beginning is dropped
constexpr off_t kKeptOutput_bytes = 64 << 10;

/// Before processes that are started without end take all processors. Only root may do so.
void come_before_others() {
  const sched_param lowest{1};
  if (sched_setscheduler(0, SCHED_RR | SCHED_RESET_ON_FORK, &lowest) == 0) return;
  setpriority(PRIO_PROCESS, 0, -10);
}

/// A child that has ended; 0 where none has, -1 once there is none.
pid_t reap_one(int* status) {
  pid_t ended = 0;
  while ((ended = waitpid(-1, status, WNOHANG)) < 0 && errno == EINTR) {
  }
  return ended;
}

class Supervisor {
 public:
  Supervisor(pid_t child, pid_t parent) : child_(child), parent_(parent) {}

  [[noreturn]] void run() {
    sigset_t heard;
    sigemptyset(&heard);
    for (const int signal : {SIGCHLD, SIGTERM, SIGTSTP, SIGCONT}) sigaddset(&heard, signal);
    for (std::chrono::nanoseconds tick = kTick;; tick = bound_output() ? kTickOfFlood : kTick) {
      const timespec patience{0, tick.count()};
      const int signal = sigtimedwait(&heard, nullptr, &patience);
      // The child has a separate process group, which a terminal does not stop.
      if (signal == SIGTSTP || signal == SIGCONT) is_stopped_ = signal == SIGTSTP;
      if (signal == SIGTSTP) kill(-child_, SIGSTOP);
      if (signal == SIGCONT) kill(-child_, SIGCONT);
      if (signal == SIGTERM || getppid() != parent_) {
        end_all();
        end_as_by(SIGTERM);
      }
      int status = 0;
      for (pid_t ended = 0; (ended = reap_one(&status)) > 0;) {
        if (ended != child_) continue;
        if (!reap_all()) end_all();
        if (WIFSIGNALED(status)) end_as_by(WTERMSIG(status));
        _exit(WEXITSTATUS(status));
      }
      if (has_too_many()) {
        end_all();
        _exit(kTooManyProcesses);
      }
    }
  }

 private:
  /// Until there is none. New ones may be started meanwhile by those that live, but what has ended
  /// counts towards the limit of a user until it is waited for. That is done once none lives: those
  /// that are at the limit then start no other one.
  void end_all() const {
    kill(-child_, SIGKILL);  // all at once: none of them starts another one
    const auto latest = Clock::now() + kPatience;
    while (Clock::now() < latest) {
      std::size_t living = 0;
      for (const Descendant& each : descendants_of(getpid())) {
        if (!each.ended && kill(each.id, SIGKILL) == 0) ++living;
      }
      if (living == 0 && reap_all()) return;
      poll(nullptr, 0, 1);
    }
  }

  /// True if no child is left.
  static bool reap_all() {
    int status = 0;
    pid_t ended = 0;
    while ((ended = reap_one(&status)) > 0) {
    }
    return ended < 0;
  }

  [[noreturn]] static void end_as_by(int signal) {
    const rlimit none{0, 0};
    setrlimit(RLIMIT_CORE, &none);  // the child has left one
    ::signal(signal, SIG_DFL);
    sigset_t only;
    sigemptyset(&only);
    sigaddset(&only, signal);
    sigprocmask(SIG_UNBLOCK, &only, nullptr);
    raise(signal);
    _exit(128 + signal);
  }

  /// They are counted one by one only where the machine has many more tasks than before.
  bool has_too_many() {
    constexpr long kFew = kMostProcesses / 4;
    const long all = all_tasks();
    usual_tasks_ = usual_tasks_ < 0 ? all : std::min(usual_tasks_, all);
    if (all - usual_tasks_ < kFew || is_stopped_) return false;
    // The more there are, the longer it takes to count them: meanwhile they start no others.
    const bool may_be_flood = all - usual_tasks_ > static_cast<long>(kMostProcesses);
    if (may_be_flood) kill(-child_, SIGSTOP);
    const std::size_t own = descendants_of(getpid(), kName).size();
    usual_tasks_ = all - static_cast<long>(own);
    if (own > kMostProcesses) return true;
    if (may_be_flood) kill(-child_, SIGCONT);
    return false;
  }

  /// True if much output was printed since the last call.
  static bool bound_output() {
    struct stat status {};
    if (fstat(STDOUT_FILENO, &status) != 0 || !S_ISREG(status.st_mode)) return false;
    constexpr blkcnt_t kBlock_bytes = 512;
    if (status.st_blocks * kBlock_bytes < kMostOutput_bytes) return false;
    fallocate(STDOUT_FILENO, FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, 0,
              status.st_size - kKeptOutput_bytes);
    return true;
  }

  pid_t child_, parent_;
  bool is_stopped_ = false;  ///< by the terminal
  long usual_tasks_ = -1;
};

/// Behind the count: where the supervisor is slower than what is started. The kernel counts all
/// threads of a user, and none of root's.
void limit_processes() {
  const long room = 1024 + 64 * std::max(sysconf(_SC_NPROCESSORS_ONLN), 1L);
  const long all = all_tasks();
  rlimit limit{};
  if (all <= 0 || getrlimit(RLIMIT_NPROC, &limit) != 0) return;
  limit.rlim_cur = std::min(limit.rlim_cur, static_cast<rlim_t>(all + room));
  setrlimit(RLIMIT_NPROC, &limit);
}

/// Only a memory file may lose its beginning.
void take_output(int output) {
  const int nothing = open("/dev/null", O_RDWR | O_CLOEXEC);
  if (nothing >= 0 || output >= 0) dup2(output >= 0 ? output : nothing, STDOUT_FILENO);
}

}  // namespace

void go_on_supervised(int output) {
  const pid_t parent = getppid(), supervisor = getpid();
  prctl(PR_SET_CHILD_SUBREAPER, 1);
  struct sigaction of_children {};
  of_children.sa_handler = SIG_DFL;  // ignored, they would end without a status
  sigaction(SIGCHLD, &of_children, nullptr);
  sigset_t all, before;
  sigfillset(&all);
  sigprocmask(SIG_SETMASK, &all, &before);
  const pid_t child = fork();
  if (child > 0) {
    prctl(PR_SET_NAME, kName);
    come_before_others();
    take_output(output);
    close_range(STDERR_FILENO + 1, ~0U, 0);
    Supervisor(child, parent).run();
  }
  if (child == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != supervisor) _exit(1);
    // This separates the scheduling groups too: without the right to come before others, the
    // supervisor has half of a processor however many processes the child starts.
    setsid();
    if (const int nothing = open("/dev/null", O_RDONLY | O_CLOEXEC); nothing > 0) {
      dup2(nothing, STDIN_FILENO);
      close(nothing);
    }
  }
  limit_processes();
  sigprocmask(SIG_SETMASK, &before, nullptr);
}

}  // namespace weft::process
