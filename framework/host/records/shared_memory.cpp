// SPDX-License-Identifier: Apache-2.0
#include "host/records/shared_memory.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <weft/core/index.hpp>
#include <weft/core/unwritten.hpp>

namespace weft::host {
namespace {

constexpr std::uint64_t kAlignment = 64;

Error refused(const std::string& what) {
  return {Errc::io, what + ": " + std::strerror(errno), "shared memory"};
}

}  // namespace

Result<std::shared_ptr<SharedMemory>> SharedMemory::create(Access access,
                                                           std::size_t reserve_bytes) {
  const int file = memfd_create("weft", MFD_CLOEXEC | MFD_ALLOW_SEALING);
  if (file < 0) return refused("cannot be created");
  auto memory = attach(file, access, reserve_bytes);
  if (!memory) return memory;
  // A reader that has checked a length must not meet a shorter file.
  int seals = F_SEAL_SHRINK;
  if (access == Access::write) seals |= F_SEAL_FUTURE_WRITE;
  if (fcntl(file, F_ADD_SEALS, seals) != 0) return refused("cannot be sealed");
  return memory;
}

Result<std::shared_ptr<SharedMemory>> SharedMemory::attach(int file, Access access,
                                                           std::size_t reserve_bytes) {
  const int protection = access == Access::write ? PROT_READ | PROT_WRITE : PROT_READ;
  void* base = mmap(nullptr, reserve_bytes, protection, MAP_SHARED | MAP_NORESERVE, file, 0);
  if (base == MAP_FAILED) {
    const Error error = refused("cannot reserve " + std::to_string(reserve_bytes) +
                                " bytes of address space (see ulimit -v)");
    close(file);
    return error;
  }
  return std::shared_ptr<SharedMemory>(new SharedMemory(file, base, reserve_bytes));
}

SharedMemory::~SharedMemory() {
  munmap(base_, reserve_bytes_);
  close(file_);
}

std::size_t SharedMemory::size() const {
  struct stat status {};
  return fstat(file_, &status) == 0 ? to_index(status.st_size) : 0;
}

bool SharedMemory::grow_to(std::size_t bytes) {
  if (bytes > reserve_bytes_) return false;
  const std::size_t before = size();
  if (bytes <= before) return true;
  const auto start = static_cast<off_t>(before), length = static_cast<off_t>(bytes - before);
  // Pages are claimed now: a full machine is an answer here, but a signal at the first access.
  int code = EINTR;
  while (code == EINTR) code = posix_fallocate(file_, start, length);
  return code == 0;
}

void* SharedMemory::at(std::uint64_t offset, std::uint64_t bytes) const {
  const std::uint64_t end = std::min<std::uint64_t>(size(), reserve_bytes_);
  return offset <= end && bytes <= end - offset ? base_ + offset : nullptr;
}

std::optional<std::uint64_t> SharedMemory::offset_of(const void* memory) const {
  const auto start = reinterpret_cast<std::uintptr_t>(base_);
  const auto place = reinterpret_cast<std::uintptr_t>(memory);
  if (place < start || place - start >= reserve_bytes_) return std::nullopt;
  return place - start;
}

Error no_room_in_shared_memory(const std::string& what) {
  rlimit limit{};
  const bool bound = getrlimit(RLIMIT_FSIZE, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY;
  return {Errc::io, "there is no room for " + what + " in shared memory" +
                        (bound ? "; the file size limit holds for it, too: see ulimit -f" : "")};
}

Result<std::shared_ptr<SharedArena>> SharedArena::create(std::size_t reserve_bytes) {
  auto memory = SharedMemory::create(SharedMemory::Access::write, reserve_bytes);
  if (!memory) return memory.error();
  return std::make_shared<SharedArena>(*std::move(memory));
}

std::shared_ptr<void> SharedArena::allocate(std::size_t bytes) {
  if (bytes > memory_->reserve_bytes()) return nullptr;
  const std::uint64_t size =
      std::max((bytes + kAlignment - 1) / kAlignment, std::size_t{1}) * kAlignment;
  const auto offset = take(size);
  if (!offset) return nullptr;
  void* block = memory_->at(*offset, size);
  mark_unwritten(block, size);
  return {block, [arena = shared_from_this(), offset = *offset, size](void*) {
            arena->give_back(offset, size);
          }};
}

std::optional<std::uint64_t> SharedArena::take(std::uint64_t bytes) {
  const std::lock_guard lock(mutex_);
  const auto found = std::find_if(free_.begin(), free_.end(),
                                  [&](const auto& room) { return room.second >= bytes; });
  if (found != free_.end()) {
    const auto [offset, room] = *found;
    free_.erase(found);
    if (room > bytes) free_.emplace(offset + bytes, room - bytes);
    return offset;
  }
  const std::uint64_t offset = end_;
  constexpr std::uint64_t kStep = 1U << 20U;
  const std::uint64_t wanted = (offset + bytes + kStep - 1) / kStep * kStep;
  if (!memory_->grow_to(std::min<std::uint64_t>(wanted, memory_->reserve_bytes())) ||
      offset + bytes > memory_->reserve_bytes()) {
    return std::nullopt;
  }
  end_ = offset + bytes;
  return offset;
}

void SharedArena::give_back(std::uint64_t offset, std::uint64_t bytes) {
  const std::lock_guard lock(mutex_);
  const auto next = free_.find(offset + bytes);
  if (next != free_.end()) {
    bytes += next->second;
    free_.erase(next);
  }
  const auto behind = free_.lower_bound(offset);
  if (behind != free_.begin()) {
    const auto before = std::prev(behind);
    if (before->first + before->second == offset) {
      offset = before->first;
      bytes += before->second;
      free_.erase(before);
    }
  }
  if (offset + bytes == end_) {
    end_ = offset;
  } else {
    free_.emplace(offset, bytes);
  }
}

}  // namespace weft::host
