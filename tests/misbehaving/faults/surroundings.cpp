// SPDX-License-Identifier: Apache-2.0
// Faults that change the shared state of the process.
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

void change_numbers() {
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

}  // namespace

void disturb_process() {
  leave_behind();
  change_numbers();
  change_signals();
  if (has("changes_folder")) {
    [[maybe_unused]] const int changed = chdir("/proc");
  }
  if (has("changes_umask")) umask(0777);
  if (has("changes_environment")) setenv("WEFT_MISBEHAVING", "1", 1);
  if (!has("uses_global_generator")) return;
  [[maybe_unused]] const int drawn = rand();
}

}  // namespace weft::faults
