// SPDX-License-Identifier: Apache-2.0
#include "host/records/memory_pool.hpp"

#include <malloc.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <weft/core/index.hpp>
#include <weft/core/unwritten.hpp>

#if defined(__SANITIZE_ADDRESS__)
#include <sanitizer/asan_interface.h>
#endif

namespace weft::host {
namespace {

constexpr std::align_val_t kAligned{MemoryPool::kAlignment};

std::size_t bytes_of(std::size_t size) { return std::size_t{1} << size; }

/// While a block is free, AddressSanitizer reports each access to it.
void forbid([[maybe_unused]] void* block, [[maybe_unused]] std::size_t bytes) {
#if defined(__SANITIZE_ADDRESS__)
  ASAN_POISON_MEMORY_REGION(block, bytes);
#endif
}
void permit([[maybe_unused]] void* block, [[maybe_unused]] std::size_t bytes) {
#if defined(__SANITIZE_ADDRESS__)
  ASAN_UNPOISON_MEMORY_REGION(block, bytes);
#endif
}

}  // namespace

std::size_t MemoryPool::size_for(std::size_t bytes) {
  return to_index(std::bit_width(std::max(bytes, kAlignment) - 1));
}

void* MemoryPool::take(std::size_t bytes) noexcept {
  const std::size_t size = size_for(bytes);
  if (size >= kSizes) return nullptr;
  {
    const std::lock_guard lock(mutex_);
    Shelf& shelf = shelves_[size];
    shelf.most = std::max(shelf.most, ++shelf.in_use);
    if (shelf.free > 0) return take_free(size);
  }
  void* block = ::operator new(bytes_of(size), kAligned, std::nothrow);
  if (block != nullptr) return block;
  const std::lock_guard lock(mutex_);
  --shelves_[size].in_use;
  return nullptr;
}

void MemoryPool::give_back(void* block, std::size_t bytes) noexcept {
  const std::size_t size = size_for(bytes);
  const std::lock_guard lock(mutex_);
  Shelf& shelf = shelves_[size];
  --shelf.in_use;
  if (is_closed_) return ::operator delete(block, kAligned);
  std::memcpy(block, &shelf.first, sizeof(void*));
  forbid(block, bytes_of(size));
  shelf.first = block;
  ++shelf.free;
}

void MemoryPool::frame_done(std::uint64_t frame) noexcept {
  const std::lock_guard lock(mutex_);
  if (std::exchange(last_frame_, frame) == frame || ++frames_ < kPeriod) return;
  frames_ = 0;
  for (std::size_t size = 0; size < kSizes; ++size) {
    Shelf& shelf = shelves_[size];
    const std::size_t kept = std::max(shelf.most, shelf.most_before);
    while (shelf.free > 0 && shelf.in_use + shelf.free > kept) drop_free(size);
    shelf.most_before = std::exchange(shelf.most, shelf.in_use);
  }
}

void MemoryPool::close() noexcept {
  const std::lock_guard lock(mutex_);
  is_closed_ = true;
  for (std::size_t size = 0; size < kSizes; ++size) {
    while (shelves_[size].free > 0) drop_free(size);
  }
}

MemoryPool::Holding MemoryPool::holding() const {
  const std::lock_guard lock(mutex_);
  Holding sum;
  for (std::size_t size = 0; size < kSizes; ++size) {
    sum.in_use += shelves_[size].in_use * bytes_of(size);
    sum.free += shelves_[size].free * bytes_of(size);
  }
  return sum;
}

void* MemoryPool::take_free(std::size_t size) noexcept {
  Shelf& shelf = shelves_[size];
  void* block = shelf.first;
  permit(block, bytes_of(size));
  std::memcpy(&shelf.first, block, sizeof(void*));
  --shelf.free;
  return block;
}

void MemoryPool::drop_free(std::size_t size) noexcept {
  ::operator delete(take_free(size), kAligned);
}

void keep_freed_memory() {
  constexpr int kLargestInHeap_bytes = 32 << 20;  // the largest value that the C library accepts
  constexpr int kMostFree_bytes = 64 << 20;
  mallopt(M_MMAP_THRESHOLD, kLargestInHeap_bytes);
  mallopt(M_TRIM_THRESHOLD, kMostFree_bytes);
}

std::shared_ptr<void> own_memory(std::size_t bytes, const std::shared_ptr<MemoryPool>& pool) try {
  struct alignas(MemoryPool::kAlignment) Line {
    std::array<std::byte, MemoryPool::kAlignment> bytes;
  };
  // One block for the contents, the line behind them and the count of references.
  constexpr std::size_t kLargest = std::size_t{1} << 46U;
  if (bytes > kLargest) return nullptr;
  const std::size_t count = (bytes + 2 * sizeof(Line) - 1) / sizeof(Line);
  auto lines = std::allocate_shared_for_overwrite<Line[]>(PoolAllocator<Line>(pool), count);
  mark_unwritten(lines.get(), bytes);
  return lines;
} catch (const std::bad_alloc&) {
  return nullptr;
}

}  // namespace weft::host
