// SPDX-License-Identifier: Apache-2.0
#include "host/loading/library_call.hpp"

#include <sys/mman.h>

#include <atomic>
#include <new>

namespace weft::host {
namespace {

using ProcessId = std::atomic<pid_t>;

/// A number that the kernel sets to 0 in each copy of the process; null where it cannot.
ProcessId* wiped_on_fork() {
  void* const page =
      mmap(nullptr, sizeof(ProcessId), PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (page == MAP_FAILED) return nullptr;
  if (madvise(page, sizeof(ProcessId), MADV_WIPEONFORK) == 0) return new (page) ProcessId(0);
  munmap(page, sizeof(ProcessId));
  return nullptr;
}

}  // namespace

pid_t process_id() {
  static ProcessId* const known = wiped_on_fork();
  if (known == nullptr) return getpid();
  pid_t id = known->load(std::memory_order_relaxed);
  if (id == 0) known->store(id = getpid(), std::memory_order_relaxed);
  return id;
}

}  // namespace weft::host
