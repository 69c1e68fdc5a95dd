// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <weft/core/result.hpp>

namespace weft::host {

/// A memory file that one process writes and others map read-only. It grows within the address
/// space reserved for it and never shrinks, so that what a reader has checked stays there.
class SharedMemory {
 public:
  enum class Access { read, write };

  static constexpr std::size_t kReserve = std::size_t{1} << 34U;  ///< [bytes] of address space

  /// A new, empty file. This process is its writer or a reader. Once this process is the writer,
  /// the kernel refuses every other one.
  static Result<std::shared_ptr<SharedMemory>> create(Access access,
                                                      std::size_t reserve_bytes = kReserve);

  /// The file that another process made; takes the descriptor over.
  static Result<std::shared_ptr<SharedMemory>> attach(int file, Access access,
                                                      std::size_t reserve_bytes);

  ~SharedMemory();
  SharedMemory(const SharedMemory&) = delete;
  SharedMemory& operator=(const SharedMemory&) = delete;

  int file() const { return file_; }
  std::size_t reserve_bytes() const { return reserve_bytes_; }
  /// [bytes] that the file has now.
  std::size_t size() const;

  /// Makes the file at least this long; false when the reserve or the machine's memory is too
  /// small.
  bool grow_to(std::size_t bytes);

  /// The memory at an offset, or null unless all of it is in the file.
  void* at(std::uint64_t offset, std::uint64_t bytes) const;

  /// The offset of memory in the file; nothing if the memory is not in the file.
  std::optional<std::uint64_t> offset_of(const void* memory) const;

 private:
  SharedMemory(int file, void* base, std::size_t reserve_bytes)
      : file_(file), base_(static_cast<std::byte*>(base)), reserve_bytes_(reserve_bytes) {}

  int file_;
  std::byte* base_;
  std::size_t reserve_bytes_;
};

/// The error where no memory is left for `what`: "there is no room for X in shared memory". Names
/// the file size limit, where one is set, since it bounds memory files, too.
Error no_room_in_shared_memory(const std::string& what);

/// Hands out blocks of a shared memory that this process writes; from any thread.
class SharedArena : public std::enable_shared_from_this<SharedArena> {
 public:
  static Result<std::shared_ptr<SharedArena>> create(
      std::size_t reserve_bytes = SharedMemory::kReserve);

  explicit SharedArena(std::shared_ptr<SharedMemory> memory) : memory_(std::move(memory)) {}

  /// Not cleared, see mark_unwritten(); 64-byte aligned, free again with its last reference; null
  /// when there is no room. It keeps the arena alive.
  std::shared_ptr<void> allocate(std::size_t bytes);

  const SharedMemory& memory() const { return *memory_; }

 private:
  std::optional<std::uint64_t> take(std::uint64_t bytes);
  void give_back(std::uint64_t offset, std::uint64_t bytes);

  std::shared_ptr<SharedMemory> memory_;
  std::mutex mutex_;
  std::map<std::uint64_t, std::uint64_t> free_;  ///< [bytes] by offset, none beside another
  std::uint64_t end_ = 0;                        ///< everything behind it is free
};

}  // namespace weft::host
