// SPDX-License-Identifier: Apache-2.0
// Loaded before the C library, so that it replaces the allocator: operator new, OpenCV, Eigen and
// all others that allocate by the C library call these functions.
#include <atomic>
#include <cerrno>
#include <cstddef>
#include <cstdint>

// The functions of glibc's own allocator that replacements of malloc can call.
// NOLINTBEGIN(bugprone-reserved-identifier): so they are called
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* block, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
}
// NOLINTEND(bugprone-reserved-identifier)

namespace {

// The allocator runs before main and has no object to keep its sums in.
std::atomic<std::uint64_t> blocks{0};
std::atomic<std::uint64_t> bytes{0};

void add(std::size_t size) {
  blocks.fetch_add(1, std::memory_order_relaxed);
  bytes.fetch_add(size, std::memory_order_relaxed);
}

}  // namespace

extern "C" {

__attribute__((visibility("default"))) void weft_allocations_so_far(std::uint64_t* of_blocks,
                                                                    std::uint64_t* of_bytes) {
  *of_blocks = blocks.load(std::memory_order_relaxed);
  *of_bytes = bytes.load(std::memory_order_relaxed);
}

__attribute__((visibility("default"))) void* malloc(std::size_t size) {
  add(size);
  return __libc_malloc(size);
}

__attribute__((visibility("default"))) void* calloc(std::size_t count, std::size_t size) {
  add(count * size);
  return __libc_calloc(count, size);
}

/// A block that grows counts as a new one.
__attribute__((visibility("default"))) void* realloc(void* block, std::size_t size) {
  add(size);
  return __libc_realloc(block, size);
}

__attribute__((visibility("default"))) void* memalign(std::size_t alignment, std::size_t size) {
  add(size);
  return __libc_memalign(alignment, size);
}

__attribute__((visibility("default"))) void* aligned_alloc(std::size_t alignment,
                                                           std::size_t size) {
  add(size);
  return __libc_memalign(alignment, size);
}

__attribute__((visibility("default"))) int posix_memalign(void** block, std::size_t alignment,
                                                          std::size_t size) {
  add(size);
  *block = __libc_memalign(alignment, size);
  return *block == nullptr ? ENOMEM : 0;
}

}  // extern "C"
