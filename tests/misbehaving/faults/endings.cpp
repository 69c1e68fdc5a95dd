// SPDX-License-Identifier: Apache-2.0
// Faults of frame 1: what ends the process, and statuses that are none.
#include <fenv.h>
#include <pthread.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>
#include <xmmintrin.h>

#include <cstdio>
#include <cstdlib>
#include <locale>
#include <stdexcept>
#include <thread>

#include "faults.hpp"

namespace weft::faults {
namespace {

/// Calls itself until the stack is full. The compiler cannot infer that `more` never changes.
int fill_the_stack(const volatile bool& more) {
  volatile char room[4096];
  room[0] = 1;
  return (more ? fill_the_stack(more) : 0) + room[0];
}

/// Maps a file without content.
void read_beyond_a_file() {
  const int file = memfd_create("nothing", 0);
  const void* const page = mmap(nullptr, 4096, PROT_READ, MAP_SHARED, file, 0);
  const volatile char read = *static_cast<const volatile char*>(page);
  static_cast<void>(read);
}

/// The CPU traps the division: no sanitizer checks it.
[[gnu::no_sanitize("undefined")]] void divide(const volatile int& number,
                                              const volatile int& nothing) {
  const volatile int result = number / nothing;
  static_cast<void>(result);
}

void end_the_process() {
  const volatile bool more = true;
  const volatile int number = 7, nothing = 0;
  if (has("segv")) write_where_nothing_is();
  if (has("segv_in_thread")) std::thread(write_where_nothing_is).join();
  if (has("bus")) read_beyond_a_file();
  if (has("fpe")) divide(number, nothing);
  if (has("ill")) __builtin_trap();
  if (has("abort")) std::abort();
  if (has("overflow")) fill_the_stack(more);
  if (has("exit")) std::exit(0);
  if (has("_exit")) _exit(0);
  if (has("quick_exit")) std::quick_exit(0);
  if (has("kernel_exit")) syscall(SYS_exit_group, 0);
  if (has("kill")) kill(getpid(), SIGKILL);
  if (has("pthread_exit")) pthread_exit(nullptr);
  if (has("hang")) std::fputs("asleep\n", stderr);
  if (has("hang")) sleep_for_ever();
  if (has("throw")) throw std::runtime_error("the sky fell down");
  if (has("close_all")) close_range(0, 20, 0);
  if (has("close_files")) close_range(3, 20, 0);
  if (has("own_handler")) {
    signal(SIGSEGV, [](int) { _exit(0); });
    write_where_nothing_is();
  }
}

}  // namespace

std::int32_t end_in_frame_1(weft_error& error) {
  end_the_process();
  if (has("latin_error")) return refuse(error, "caf\xe9");
  if (has("status")) return -77;
  return has("end") ? WEFT_END : WEFT_OK;
}

bool is_mode_changed() {
  return std::fegetround() != FE_TONEAREST || _MM_GET_FLUSH_ZERO_MODE() != _MM_FLUSH_ZERO_OFF ||
         std::locale() != std::locale::classic();
}

}  // namespace weft::faults
