// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <new>
#include <type_traits>
#include <utility>
#include <vector>

namespace weft::host {

/// Memory that is reused from frame to frame: a returned block is handed out again, without
/// clearing, to the next caller that needs the same size. Sizes are powers of two; a page that is
/// never touched costs nothing.
///
/// For each size, the pool keeps as many blocks as were in use at once in this or the last period
/// of frames. At the end of a period the other blocks return to the allocator. The pool thus grows
/// and shrinks with the data, and contains at most the recent need of frames. Safe from any thread.
class MemoryPool {
 public:
  static constexpr std::size_t kAlignment = 64;
  static constexpr int kPeriod = 64;  ///< [frames]

  MemoryPool() = default;
  ~MemoryPool() { close(); }
  MemoryPool(const MemoryPool&) = delete;
  MemoryPool& operator=(const MemoryPool&) = delete;

  /// At least `bytes` bytes, not cleared; null if memory is short.
  void* take(std::size_t bytes) noexcept;

  /// Returns a block that was taken with this number of bytes.
  void give_back(void* block, std::size_t bytes) noexcept;

  /// Reports that this frame is finished. If several pipelines in step report it, the first report
  /// counts.
  void frame_done(std::uint64_t frame) noexcept;

  /// Keeps nothing from now on. Blocks in use stay so, and go when they are given back.
  void close() noexcept;

  struct Holding {
    std::size_t in_use = 0, free = 0;  ///< [bytes]
  };
  Holding holding() const;

 private:
  /// The blocks of one size.
  struct Shelf {
    void* first = nullptr;             ///< first free block; each begins with the address of the
                                       ///< next
    std::size_t free = 0, in_use = 0;  ///< [] numbers of blocks
    std::size_t most = 0, most_before = 0;  ///< in use at once in this period, in the last one
  };
  static constexpr std::size_t kSizes = 48;

  static std::size_t size_for(std::size_t bytes);
  void* take_free(std::size_t size) noexcept;
  void drop_free(std::size_t size) noexcept;

  mutable std::mutex mutex_;
  std::array<Shelf, kSizes> shelves_{};  ///< by the logarithm of the size
  int frames_ = 0;                       ///< frames in this period
  std::uint64_t last_frame_ = ~std::uint64_t{0};
  bool is_closed_ = false;
};

/// Lets containers and shared objects allocate from a pool, which lives as long as they do; without
/// a pool, from the default allocator.
template <class T>
class PoolAllocator {
 public:
  using value_type = T;
  using propagate_on_container_move_assignment = std::true_type;
  using propagate_on_container_swap = std::true_type;

  PoolAllocator() = default;
  PoolAllocator(std::shared_ptr<MemoryPool> pool) : pool_(std::move(pool)) {}
  template <class Other>
  PoolAllocator(const PoolAllocator<Other>& other) : pool_(other.pool()) {}

  T* allocate(std::size_t count) {
    static_assert(alignof(T) <= MemoryPool::kAlignment);
    if (count > ~std::size_t{0} / sizeof(T)) throw std::bad_array_new_length();
    const std::size_t bytes = count * sizeof(T);
    void* block = pool_ != nullptr
                      ? pool_->take(bytes)
                      : ::operator new (bytes, std::align_val_t{alignof(T)}, std::nothrow);
    if (block == nullptr) throw std::bad_alloc();
    return static_cast<T*>(block);
  }
  void deallocate(T* block, std::size_t count) noexcept {
    if (pool_ != nullptr) return pool_->give_back(block, count * sizeof(T));
    ::operator delete (block, std::align_val_t{alignof(T)});
  }

  const std::shared_ptr<MemoryPool>& pool() const { return pool_; }

  template <class Other>
  friend bool operator==(const PoolAllocator& a, const PoolAllocator<Other>& b) {
    return a.pool() == b.pool();
  }

 private:
  std::shared_ptr<MemoryPool> pool_;
};

/// A list whose elements are stored in a pool.
template <class T>
using PooledVector = std::vector<T, PoolAllocator<T>>;

/// From now on, the allocator of this process keeps up to 64 MiB of freed memory for the next
/// frame. Otherwise it returns large blocks to the kernel, which clears thousands of pages in each
/// frame. For the main functions of programs; a library does not change its process.
void keep_freed_memory();

/// 64-byte aligned, not cleared and marked as unwritten, with a line behind that may be read; of
/// the allocator where there is no pool. Null when memory is short.
std::shared_ptr<void> own_memory(std::size_t bytes, const std::shared_ptr<MemoryPool>& pool);

}  // namespace weft::host
