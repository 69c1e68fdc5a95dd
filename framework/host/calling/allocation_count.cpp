// SPDX-License-Identifier: Apache-2.0
#include "host/calling/allocation_count.hpp"

#include <dlfcn.h>

namespace weft::host {
namespace {

using Reader = void (*)(std::uint64_t* blocks, std::uint64_t* bytes);

/// The libraries loaded before the program starts do not change while it runs.
Reader reader() {
  static const auto found =
      reinterpret_cast<Reader>(dlsym(RTLD_DEFAULT, "weft_allocations_so_far"));
  return found;
}

}  // namespace

bool allocations_are_counted() { return reader() != nullptr; }

Allocations allocations_of_process() {
  Allocations counted;
  if (const Reader read = reader()) read(&counted.blocks, &counted.bytes);
  return counted;
}

}  // namespace weft::host
