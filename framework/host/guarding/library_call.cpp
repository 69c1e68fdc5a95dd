// SPDX-License-Identifier: Apache-2.0
#include "host/guarding/library_call.hpp"

#include <sys/mman.h>

#include <array>
#include <atomic>
#include <cstdio>
#include <new>

namespace weft::host {
namespace {

using ProcessId = std::atomic<pid_t>;

/// The message of an ended copy to the original process.
struct EndedCopy {
  std::atomic<pid_t> original{0};  ///< 0: no message
  std::array<char, 128> component{};
};

/// A separate page of memory; null if the kernel has none.
template <class Content>
Content* page_of(int sharing) {
  void* const page =
      mmap(nullptr, sizeof(Content), PROT_READ | PROT_WRITE, sharing | MAP_ANONYMOUS, -1, 0);
  return page != MAP_FAILED ? new (page) Content{} : nullptr;
}

/// A number that the kernel sets to 0 in each copy of the process; null where it cannot.
ProcessId* wiped_on_fork() {
  auto* const id = page_of<ProcessId>(MAP_PRIVATE);
  if (id == nullptr || madvise(id, sizeof(ProcessId), MADV_WIPEONFORK) == 0) return id;
  munmap(id, sizeof(ProcessId));
  return nullptr;
}

/// All copies of this process write here. If two end at once, one of them is reported.
EndedCopy* ended_copy() {
  static EndedCopy* const page = page_of<EndedCopy>(MAP_SHARED);
  return page;
}

}  // namespace

pid_t process_id() {
  // Both pages lie there before the first copy is made.
  static ProcessId* const known = (static_cast<void>(ended_copy()), wiped_on_fork());
  if (known == nullptr) return getpid();
  pid_t id = known->load(std::memory_order_relaxed);
  if (id == 0) known->store(id = getpid(), std::memory_order_relaxed);
  return id;
}

void OneProcess::end_copy(pid_t original, const char* component) {
  if (EndedCopy* const ended = ended_copy(); ended != nullptr) {
    std::snprintf(ended->component.data(), ended->component.size(), "%s", component);
    ended->original.store(original, std::memory_order_release);
  }
  _exit(0);
}

std::string maker_of_ended_copy() {
  EndedCopy* const ended = ended_copy();
  if (ended == nullptr || ended->original.load(std::memory_order_acquire) != process_id())
    return {};
  std::string component = ended->component.data();
  ended->original.store(0, std::memory_order_release);
  return component;
}

Result<const void*> find_extension(const weft_component& component, const char* name,
                                   std::size_t bytes) {
  if (component.get_extension == nullptr) return nullptr;
  const void* found = nullptr;
  weft_error error = kNoError;
  const std::int32_t status =
      call_library(component.id, error, [&] { found = component.get_extension(&component, name); });
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
