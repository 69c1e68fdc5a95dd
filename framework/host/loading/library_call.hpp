// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>
#include <unistd.h>

#include <weft/sdk/extensions.hpp>

#include "host/loading/first_sizes.hpp"
#include "host/loading/floating_point.hpp"

namespace weft::host {

/// getpid() without a system call for each, also in a copy that a library made by a bare system
/// call.
pid_t process_id();

/// While a library is at work: ends a copy of the process that it makes with fork() and lets
/// return. Two processes would go on from here, answer the same call and write the same files.
class OneProcess {
 public:
  OneProcess() = default;
  ~OneProcess() {
    if (process_id() != process_) _exit(0);
  }
  OneProcess(const OneProcess&) = delete;
  OneProcess& operator=(const OneProcess&) = delete;

 private:
  pid_t process_ = process_id();
};

/// The status of a function of a library. The library may break its contract: an exception becomes
/// its error, and the floating-point mode is restored. `kept_mode` is false if that was necessary.
template <class Function>
std::int32_t call_library(weft_error& error, Function&& function, bool* kept_mode = nullptr) {
  const OneProcess one;
  const FloatingPointMode mode;
  const std::int32_t status = detail::guarded(&error, function);
  const bool kept = mode.restore();
  if (kept_mode != nullptr) *kept_mode = kept;
  return status;
}

/// An extension of a component; null if it has none. Fails if the library throws, or if the table
/// is smaller than `bytes`.
Result<const void*> find_extension(const weft_component& component, const char* name,
                                   std::size_t bytes);

/// As above, with the type of the table in version 1.0.
template <class Table>
Result<const Table*> extension_of(const weft_component& component, const char* name) {
  const auto found = find_extension(component, name, kFirstSize<Table>);
  if (!found) return found.error();
  return static_cast<const Table*>(*found);
}

}  // namespace weft::host
