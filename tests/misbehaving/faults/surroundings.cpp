// SPDX-License-Identifier: Apache-2.0
// Faults that change the shared state of the process.
#include <fcntl.h>
#include <pthread.h>
#include <sched.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cfenv>
#include <chrono>
#include <clocale>
#include <csignal>
#include <cstdio>
#include <exception>
#include <locale>
#include <memory>
#if defined(__SSE__)
#include <xmmintrin.h>
#endif

#include "faults.hpp"

namespace weft::faults {
namespace {

using namespace std::chrono_literals;

void leave_behind() {
  if (has("leaks_slowly")) std::this_thread::sleep_for(20ms);
  if (has("leaks_memory") || has("leaks_slowly")) {
    auto block = std::make_unique<std::array<unsigned char, 1024>>();
    block->fill(1);
    static std::atomic<void*> last = nullptr;  // or the compiler leaves the block out
    last = block.release();
  }
  if (has("leaks_descriptor")) {
    [[maybe_unused]] const int left = open("/dev/null", O_RDONLY | O_CLOEXEC);
  }
  if (has("leaves_thread")) std::thread(sleep_for_ever).detach();
}

void flush_denormals() {
#if defined(__SSE__)
  constexpr unsigned kFlushAndZero = 0x8040;
  _mm_setcsr(_mm_getcsr() | kFlushAndZero);
#endif
}

/// Rounds each result to 53 bits, where long double has more.
void lower_precision() {
#if defined(__x86_64__)
  std::uint16_t control = 0;
  __asm__ volatile("fnstcw %0" : "=m"(control));
  control = static_cast<std::uint16_t>((control & ~0x300U) | 0x200U);
  __asm__ volatile("fldcw %0" : : "m"(control));
#endif
}

/// Numbers with a decimal comma.
struct DecimalComma : std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
};

void change_numbers() {
  if (has("changes_precision")) lower_precision();
  if (has("changes_locale_of_streams")) {
    std::locale::global(std::locale(std::locale(), new DecimalComma));
  }
  if (has("changes_locale")) setlocale(LC_ALL, "C.UTF-8");
  if (has("changes_rounding")) std::fesetround(FE_UPWARD);
  if (has("flushes_denormals")) flush_denormals();
}

void change_signals() {
  if (has("changes_signal_handler")) std::signal(SIGINT, [](int) {});
  if (!has("changes_signal_mask")) return;
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
}

/// Files of the process may have 16 bytes: the next that it writes is cut.
void limit_files() {
  rlimit limit{};
  getrlimit(RLIMIT_FSIZE, &limit);
  limit.rlim_cur = 16;
  setrlimit(RLIMIT_FSIZE, &limit);
}

/// Ends the process by SIGALRM soon, unless the timer is stopped.
void start_timer() {
  const itimerval soon{{0, 0}, {0, 300'000}};
  setitimer(ITIMER_REAL, &soon, nullptr);
}

void run_on_one_processor() {
  cpu_set_t set;
  sched_getaffinity(0, sizeof(set), &set);
  std::size_t first = 0;
  while (!CPU_ISSET(first, &set)) ++first;
  CPU_ZERO(&set);
  CPU_SET(first, &set);
  sched_setaffinity(0, sizeof(set), &set);
}

void change_kernel_settings() {
  if (has("limits_files")) limit_files();
  if (has("starts_timer")) start_timer();
  if (has("changes_affinity")) run_on_one_processor();
  if (has("changes_priority")) {
    setpriority(PRIO_PROCESS, 0, getpriority(PRIO_PROCESS, 0) + 1);
  }
}

void change_surroundings() {
  if (has("changes_folder")) {
    [[maybe_unused]] const int changed = chdir("/proc");
  }
  if (has("changes_umask")) umask(0777);
  if (has("changes_environment")) setenv("WEFT_MISBEHAVING", "1", 1);
  if (has("clears_environment")) clearenv();
  if (has("changes_time_zone")) setenv("TZ", "XYZ-3", 1);
}

/// Handlers for the end of the process and for uncaught exceptions.
void register_handlers() {
  if (has("crashes_at_exit")) std::atexit(write_where_nothing_is);
  if (has("hangs_at_exit")) std::atexit([] { sleep_for_ever(); });
  if (has("changes_terminate")) std::set_terminate([] { _exit(0); });
}

}  // namespace

void disturb_process(std::string_view place) {
  if (!is_place(place)) return;
  leave_behind();
  change_numbers();
  change_signals();
  change_kernel_settings();
  change_surroundings();
  register_handlers();
  if (has("prints")) std::puts("{\"what\": \"nobody asked for\"}");
  if (has("returns_twice")) static_cast<void>(fork());
  if (!has("uses_global_generator")) return;
  [[maybe_unused]] const int drawn = rand();
}

}  // namespace weft::faults
