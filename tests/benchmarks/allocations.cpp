// SPDX-License-Identifier: Apache-2.0
#include "allocations.hpp"

#include <atomic>
#include <cerrno>
#include <cstddef>

// glibc's own allocator by the names that it keeps for those who stand in for malloc.
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* block, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
}

namespace {

// The allocator runs before main and has no object to keep a count in.
std::atomic<std::uint64_t> count{0};

void add() { count.fetch_add(1, std::memory_order_relaxed); }

}  // namespace

extern "C" {

void* malloc(std::size_t size) {
  add();
  return __libc_malloc(size);
}

void* calloc(std::size_t number, std::size_t size) {
  add();
  return __libc_calloc(number, size);
}

void* realloc(void* block, std::size_t size) {
  add();
  return __libc_realloc(block, size);
}

void* memalign(std::size_t alignment, std::size_t size) {
  add();
  return __libc_memalign(alignment, size);
}

void* aligned_alloc(std::size_t alignment, std::size_t size) {
  add();
  return __libc_memalign(alignment, size);
}

int posix_memalign(void** block, std::size_t alignment, std::size_t size) {
  add();
  *block = __libc_memalign(alignment, size);
  return *block == nullptr ? ENOMEM : 0;
}

}  // extern "C"

namespace weft::bench {

std::uint64_t allocations() { return count.load(std::memory_order_relaxed); }

}  // namespace weft::bench
