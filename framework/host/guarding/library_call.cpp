// SPDX-License-Identifier: Apache-2.0
#include "host/guarding/library_call.hpp"

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

Result<const void*> find_extension(const weft_component& component, const char* name,
                                   std::size_t bytes) {
  if (component.get_extension == nullptr) return nullptr;
  const void* found = nullptr;
  weft_error error = kNoError;
  const std::int32_t status = call_library(error, [&] {
    found = component.get_extension(&component, name);
    return WEFT_OK;
  });
  const auto damaged = [&](const std::string& cause) {
    return Error{Errc::plugin_failure,
                 std::string("its extension ") + name + " " + cause + "; rebuild the plugin",
                 component.id};
  };
  if (status != WEFT_OK) return damaged(error.message);
  // Each table begins with its size.
  if (found != nullptr && *static_cast<const std::uint32_t*>(found) < bytes) {
    return damaged("is damaged: its struct_size is too small");
  }
  return found;
}

}  // namespace weft::host
