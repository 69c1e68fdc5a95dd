// SPDX-License-Identifier: Apache-2.0
// What the animal does when it is made, called and destroyed: nothing wrong but its one mistake, in
// the second frame.
#include <fenv.h>
#include <pthread.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>
#include <xmmintrin.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <locale>
#include <stdexcept>

#include "animal.hpp"

namespace zoo {
namespace {

/// Calls itself until the stack is full: only the caller knows that `more` never changes.
int fill_the_stack(const volatile bool& more) {
  volatile char room[4096];
  room[0] = 1;
  return (more ? fill_the_stack(more) : 0) + room[0];
}

/// Memory that a file of no length would have to give.
void read_beyond_a_file() {
  const int file = memfd_create("nothing", 0);
  const void* const page = mmap(nullptr, 4096, PROT_READ, MAP_SHARED, file, 0);
  const volatile char read = *static_cast<const volatile char*>(page);
  static_cast<void>(read);
}

/// As the processor does it: no sanitizer answers in its place.
[[gnu::no_sanitize("undefined")]] void divide(const volatile int& number,
                                              const volatile int& nothing) {
  const volatile int result = number / nothing;
  static_cast<void>(result);
}

void run_away() {
  const volatile bool more = true;
  const volatile int number = 7, nothing = 0;
  if (is("segv")) write_where_nothing_is();
  if (is("bus")) read_beyond_a_file();
  if (is("fpe")) divide(number, nothing);
  if (is("ill")) __builtin_trap();
  if (is("abort")) std::abort();
  if (is("overflow")) fill_the_stack(more);
  if (is("exit")) std::exit(0);
  if (is("_exit")) _exit(0);
  if (is("quick_exit")) std::quick_exit(0);
  if (is("kernel_exit")) syscall(SYS_exit_group, 0);
  if (is("kill")) kill(getpid(), SIGKILL);
  if (is("pthread_exit")) pthread_exit(nullptr);
  if (is("hang")) fputs("asleep\n", stderr);
  if (is("hang")) sleep_for_ever();
  if (is("throw")) throw std::runtime_error("the sky fell down");
}

void misbehave() {
  if (is("close_all")) close_range(0, 20, 0);
  if (is("close_files")) close_range(3, 20, 0);
  if (is("chdir") && chdir("/") != 0) return;
  if (is("rounds")) std::fesetround(FE_UPWARD);
  if (is("flushes")) _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
  if (is("own_handler")) {
    signal(SIGSEGV, [](int) { _exit(0); });
    write_where_nothing_is();
  }
}

/// Whether what this library once set holds for others, too.
bool is_still_changed() {
  return std::fegetround() != FE_TONEAREST || _MM_GET_FLUSH_ZERO_MODE() != _MM_FLUSH_ZERO_OFF ||
         std::locale() != std::locale::classic();
}

/// As alloc gives it; null where it is refused.
void* allocate(const weft_call* call, const char* array, std::int32_t dtype, std::int64_t count) {
  return call->host->alloc(call, "inlier_mask", "inlier_mask/1", array, dtype, 1, &count);
}

}  // namespace

std::int32_t create(const weft_create*, void** self, weft_error*) {
  if (is("create_null")) return WEFT_OK;
  if (is("create_crashes")) write_where_nothing_is();
  if (is("create_exits")) std::exit(0);
  if (is("create_hangs")) sleep_for_ever();
  if (is("create_throws")) throw 42;
  *self = new int;
  return is("create_status") ? 77 : WEFT_OK;
}

std::int32_t prepare(void*, const weft_call*, const weft_record*, std::uint64_t, weft_error*) {
  if (is("prepare_crashes")) write_where_nothing_is();
  if (is("prepare_exits")) std::exit(0);
  return is("prepare_status") ? -5 : WEFT_OK;
}

std::int32_t process(void*, const weft_call* call, const weft_record* inputs, std::uint64_t count,
                     weft_error* error) {
  if (call->frame == 1) run_away();
  if (call->frame == 1) misbehave();
  if (call->frame == 1 && is("latin_error")) {
    std::strcpy(error->message, "caf\xe9");
    return WEFT_ERROR;
  }
  if (call->frame != 1 && is_still_changed()) {
    std::strcpy(error->message, "numbers are still computed or written my way");
    return WEFT_ERROR;
  }
  if (call->frame == 1 && is("status")) return -77;
  if (call->frame == 1 && is("end")) return WEFT_END;
  const auto is_matches = [](const weft_record& record) {
    return std::string_view(record.slot) == "correspondences";
  };
  const std::int64_t n = std::find_if(inputs, inputs + count, is_matches)->arrays[0].shape[0];
  auto* kept = static_cast<std::uint8_t*>(allocate(call, "kept", WEFT_U8, n));
  auto* score = static_cast<double*>(allocate(call, "score", WEFT_F64, n));
  if (kept == nullptr || score == nullptr) return WEFT_ERROR;
  std::fill_n(kept, n, std::uint8_t{1});
  std::fill_n(score, n, 1.0 / 3.0);
  return WEFT_OK;
}

void destroy(void* self) {
  if (is("destroy_crashes")) write_where_nothing_is();
  if (is("destroy_exits")) std::exit(0);
  delete static_cast<int*>(self);
}

}  // namespace zoo
