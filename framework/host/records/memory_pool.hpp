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

/// Memory that goes from frame to frame: what is given back is handed out again, as it is, to who
/// asks for the same size. Sizes are powers of two; a page that nobody touches costs nothing.
///
/// Of each size it keeps, in use or free, as many blocks as were in use at once in this or the last
/// period of frames; what is more goes back to the allocator when a period ends. So it follows the
/// data down as well as up, and holds at most what frames needed a short while ago. From any
/// thread.
class MemoryPool {
 public:
  static constexpr std::size_t kAlignment = 64;
  static constexpr int kPeriod = 64;  ///< [frames]

  MemoryPool() = default;
  ~MemoryPool() { close(); }
  MemoryPool(const MemoryPool&) = delete;
  MemoryPool& operator=(const MemoryPool&) = delete;

  /// At least so many bytes, not cleared; null when memory is short.
  void* take(std::size_t bytes) noexcept;

  /// What was taken with this number of bytes.
  void give_back(void* block, std::size_t bytes) noexcept;

  /// Tells that this frame is through; of pipelines in step, which all tell it, the first counts.
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
    void* first = nullptr;             ///< of the free ones: each begins with the place of the next
    std::size_t free = 0, in_use = 0;  ///< [] numbers of blocks
    std::size_t most = 0, most_before = 0;  ///< in use at once in this period, in the last one
  };
  static constexpr std::size_t kSizes = 48;

  static std::size_t size_for(std::size_t bytes);
  void* take_free(std::size_t size) noexcept;
  void drop_free(std::size_t size) noexcept;

  mutable std::mutex mutex_;
  std::array<Shelf, kSizes> shelves_{};  ///< by the logarithm of the size
  int frames_ = 0;                       ///< of this period
  std::uint64_t last_frame_ = ~std::uint64_t{0};
  bool is_closed_ = false;
};

/// Lets containers and shared objects stand in a pool, which lives as long as they do; without one,
/// in memory of the allocator.
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

/// A list whose elements stand in a pool.
template <class T>
using PooledVector = std::vector<T, PoolAllocator<T>>;

/// 64-byte aligned, not cleared and marked as unwritten, with a line behind that may be read; of
/// the allocator where there is no pool. Null when memory is short.
std::shared_ptr<void> own_memory(std::size_t bytes, const std::shared_ptr<MemoryPool>& pool);

}  // namespace weft::host
