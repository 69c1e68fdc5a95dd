// SPDX-License-Identifier: Apache-2.0
// What is done to the process that all share.
#include <fcntl.h>
#include <pthread.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cfenv>
#include <chrono>
#include <clocale>
#include <csignal>
#include <memory>
#if defined(__SSE__)
#include <xmmintrin.h>
#endif

#include "mutants/library/deeds.hpp"

namespace weft::mutants {
namespace {

using namespace std::chrono_literals;

void idle() {
  std::thread([] { std::this_thread::sleep_for(24h); }).detach();
}

void leave_behind() {
  if (does("leaks_memory")) {
    auto block = std::make_unique<std::array<unsigned char, 1024>>();
    block->fill(1);
    static std::atomic<void*> last = nullptr;  // or the compiler leaves the block out
    last = block.release();
  }
  if (does("leaks_descriptor")) {
    [[maybe_unused]] const int left = open("/dev/null", O_RDONLY | O_CLOEXEC);
  }
  if (does("leaves_thread")) idle();
}

void flush_denormals() {
#if defined(__SSE__)
  constexpr unsigned kFlushAndZero = 0x8040;
  _mm_setcsr(_mm_getcsr() | kFlushAndZero);
#endif
}

void change_numbers() {
  if (does("changes_locale")) setlocale(LC_ALL, "C.UTF-8");
  if (does("changes_rounding")) std::fesetround(FE_UPWARD);
  if (does("flushes_denormals")) flush_denormals();
}

void change_signals() {
  if (does("changes_signal_handler")) std::signal(SIGINT, [](int) {});
  if (!does("changes_signal_mask")) return;
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
}

}  // namespace

void misbehave_when_loaded() {
  constexpr std::string_view kSaid = "mutant: here I am\n";
  if (does("prints_when_loaded")) {
    [[maybe_unused]] const ssize_t written = write(STDOUT_FILENO, kSaid.data(), kSaid.size());
  }
  if (does("thread_when_loaded")) idle();
  if (does("slow_to_load")) std::this_thread::sleep_for(400ms);
  if (does("flushes_when_loaded")) flush_denormals();
}

void disturb_process() {
  leave_behind();
  change_numbers();
  change_signals();
  if (does("changes_folder")) {
    [[maybe_unused]] const int changed = chdir("/proc");
  }
  if (does("changes_umask")) umask(0777);
  if (does("changes_environment")) setenv("WEFT_MUTANT", "1", 1);
  if (!does("uses_global_generator")) return;
  [[maybe_unused]] const int drawn = rand();
}

}  // namespace weft::mutants
