// SPDX-License-Identifier: Apache-2.0
#include "kit/conformance/probes/process_state.hpp"

#include <dlfcn.h>
#include <link.h>
#include <malloc.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cfenv>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

#include "host/guarding/process_state.hpp"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define WEFT_SANITIZER_ALLOCATES
// Declared in sanitizer/allocator_interface.h, which GCC does not install.
extern "C" std::size_t __sanitizer_get_current_allocated_bytes();
#endif

namespace weft::conformance {
namespace {

std::size_t entries_of(const char* folder) {
  std::size_t count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    static_cast<void>(entry);
    ++count;
  }
  return count;
}

std::string environment() {
  std::vector<std::string> all;
  for (char** entry = environ; entry != nullptr && *entry != nullptr; ++entry) {
    all.emplace_back(*entry);
  }
  std::sort(all.begin(), all.end());
  std::string text;
  for (const std::string& entry : all) text += entry + "\n";
  return text;
}

}  // namespace

std::size_t count_descriptors() { return entries_of("/proc/self/fd"); }
std::size_t count_threads() { return entries_of("/proc/self/task"); }

#ifdef WEFT_SANITIZER_ALLOCATES
std::int64_t heap_bytes() {
  return static_cast<std::int64_t>(__sanitizer_get_current_allocated_bytes());
}

// It keeps what is freed for a while, which makes the process larger.
std::int64_t resident_bytes() { return heap_bytes(); }
#else
std::int64_t heap_bytes() {
  const struct mallinfo2 heap = mallinfo2();
  return static_cast<std::int64_t>(heap.uordblks + heap.hblkhd);
}

std::int64_t resident_bytes() {
  std::ifstream file("/proc/self/statm");
  std::int64_t total = 0, resident = 0;
  file >> total >> resident;
  return resident * sysconf(_SC_PAGESIZE);
}
#endif

std::int64_t printed_bytes() {
  std::fflush(nullptr);
  struct stat known {};
  return fstat(STDOUT_FILENO, &known) == 0 ? known.st_size : 0;
}

double processor_ms() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
}

double queued_ms(int thread) {
  std::ifstream file("/proc/self/task/" + std::to_string(thread) + "/schedstat");
  double computed_ns = 0.0, queued_ns = 0.0;
  file >> computed_ns >> queued_ns;
  return 1e-6 * queued_ns;
}

std::string floating_point_mode() {
  std::ostringstream text;
  text << std::hex << "rounding " << std::fegetround();
#if defined(__x86_64__)
  constexpr unsigned kFlags = 0x3F;  // exception flags that computations set
  std::uint16_t x87 = 0;             // its precision, for long double
  __asm__ volatile("fnstcw %0" : "=m"(x87));
  text << ", control " << (_mm_getcsr() & ~kFlags) << " and " << x87;
#endif
  return text.str();
}

std::map<std::string, std::string> process_state() {
  const host::ProcessState state;
  std::string settings;
  for (const char* part : {"resource limits", "timers", "CPU affinity", "priority"}) {
    settings += part + (": " + state.text(part)) + "\n";
  }
  return {{"locale", state.text("locale")},
          {"floating_point", floating_point_mode()},
          {"signals", state.text("signals")},
          {"working_directory", state.text("working directory")},
          {"umask", state.text("umask")},
          {"environment", environment()},
          {"process", settings + "terminate handler: " + state.text("terminate handler")}};
}

int opencv_threads() {
  std::string path;
  const auto look = [](dl_phdr_info* info, std::size_t /*size*/, void* found) {
    const bool is_it = std::strstr(info->dlpi_name, "libopencv_core") != nullptr;
    if (is_it) *static_cast<std::string*>(found) = info->dlpi_name;
    return is_it ? 1 : 0;
  };
  dl_iterate_phdr(look, &path);
  if (path.empty()) return -1;
  void* library = dlopen(path.c_str(), RTLD_NOLOAD | RTLD_LAZY);
  if (library == nullptr) return -1;
  using Count = int (*)();
  const auto count = reinterpret_cast<Count>(dlsym(library, "_ZN2cv13getNumThreadsEv"));
  const int threads = count != nullptr ? count() : -1;
  dlclose(library);
  return threads;
}

}  // namespace weft::conformance
