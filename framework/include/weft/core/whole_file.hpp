// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fcntl.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <weft/core/result.hpp>

namespace weft {

/// Returns the reason of a failed write as text.
inline std::string why_not_written(std::error_code code) {
  if (code == std::errc::file_too_large) return "it is beyond the file size limit, see ulimit -f";
  return code.message();
}

/// Returns whether writes to a path go to a device: a terminal, a pipe or /dev/stdout, which may
/// lead to an open file.
inline bool is_device(const std::filesystem::path& file) {
  namespace fs = std::filesystem;
  const std::string name = file.lexically_normal().string();
  if (name == "/dev/stdout" || name == "/dev/stderr") return true;
  if (name.starts_with("/dev/fd/") || name.starts_with("/proc/")) return true;
  std::error_code code;
  const fs::file_status status = fs::status(file, code);
  return fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status);
}

/// Specifies if a file must survive a power cut after its writer returned. Files written per frame
/// are not synced, because a wait for the disk would slow the frames down.
enum class Durability { synced, unsynced };

inline std::error_code last_system_error() { return {errno, std::generic_category()}; }

/// Syncs an open file or folder to the disk. A file system without this operation is not an error.
inline std::error_code sync_open(int descriptor) {
  if (::fsync(descriptor) == 0 || errno == EINVAL || errno == ENOTSUP) return {};
  return last_system_error();
}

/// Syncs a path to the disk. An unreadable folder is not an error.
inline std::error_code sync_path(const std::filesystem::path& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0) return errno == EACCES ? std::error_code() : last_system_error();
  const std::error_code code = sync_open(descriptor);
  ::close(descriptor);
  return code;
}

/// Syncs the whole file system of `path` to the disk, with one wait instead of one per file.
inline std::error_code sync_file_system(const std::filesystem::path& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return last_system_error();
  const std::error_code code = ::syncfs(descriptor) == 0 ? std::error_code() : last_system_error();
  ::close(descriptor);
  return code;
}

inline std::error_code write_all(int descriptor, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::write(descriptor, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return last_system_error();
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
  return {};
}

/// Returns the folder that contains a path.
inline std::filesystem::path folder_of(const std::filesystem::path& path) {
  return path.has_parent_path() ? path.parent_path() : ".";
}

/// A new file with a temporary name next to `file`, NAME.<12 hexadecimal digits>.part. It never
/// writes through a link or into a file of another writer. The destructor removes it unless
/// finish() has renamed it. finish() returns the first error.
class UnfinishedFile {
 public:
  explicit UnfinishedFile(std::filesystem::path file) : file_(std::move(file)) {
    constexpr int kTries = 100;
    constexpr int kFlags = O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC;
    errno = EEXIST;
    for (int i = 0; i < kTries && descriptor_ < 0 && errno == EEXIST; ++i) {
      path_ = temporary_name();
      descriptor_ = ::open(path_.c_str(), kFlags, 0666);
    }
    if (descriptor_ < 0) status_ = last_system_error();
  }
  UnfinishedFile(const UnfinishedFile&) = delete;
  UnfinishedFile& operator=(const UnfinishedFile&) = delete;
  ~UnfinishedFile() {
    if (descriptor_ < 0) return;
    ::close(descriptor_);
    ::unlink(path_.c_str());
  }

  /// The temporary path. Other code may write or rename by this name.
  const std::filesystem::path& path() const { return path_; }

  /// The reason of a failed creation or write; empty if there is none.
  std::error_code status() const { return status_; }

  void write(std::string_view bytes) {
    if (!status_) status_ = write_all(descriptor_, bytes);
  }

  /// Renames the file to its final name and replaces an existing file.
  std::error_code finish(Durability durability) {
    const bool is_synced = durability == Durability::synced;
    if (!status_ && is_synced) status_ = sync();
    if (!status_ && ::rename(path_.c_str(), file_.c_str()) != 0) status_ = last_system_error();
    if (status_) return status_;
    if (::close(std::exchange(descriptor_, -1)) != 0) status_ = last_system_error();
    if (!status_ && is_synced) status_ = sync_path(folder_of(file_));
    return status_;
  }

 private:
  std::error_code sync() const {
    struct stat status {};
    const bool is_replaced = ::fstat(descriptor_, &status) == 0 && status.st_nlink == 0;
    return is_replaced ? sync_path(path_) : sync_open(descriptor_);
  }

  std::filesystem::path temporary_name() const {
    constexpr std::size_t kLongest = 200;  // leaves room for the suffix of a long name
    std::uint64_t random = 0;
    static_cast<void>(!getrandom(&random, sizeof(random), 0));
    char ending[24];
    std::snprintf(ending, sizeof(ending), ".%012llx.part",
                  static_cast<unsigned long long>(random >> 16U));
    return folder_of(file_) / (file_.filename().string().substr(0, kLongest) + ending);
  }

  std::filesystem::path file_, path_;
  int descriptor_ = -1;
  std::error_code status_;
};

/// Writes a file that appears completely or not at all, see UnfinishedFile. Devices are written
/// directly.
inline Result<void> write_whole(std::string_view bytes, const std::filesystem::path& file,
                                Durability durability = Durability::synced) {
  std::error_code code;
  if (is_device(file)) {
    const int device = ::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    code = device < 0 ? last_system_error() : write_all(device, bytes);
    if (device >= 0 && ::close(device) != 0 && !code) code = last_system_error();
  } else {
    UnfinishedFile unfinished(file);
    unfinished.write(bytes);
    code = unfinished.finish(durability);
  }
  if (!code) return {};
  return Error{Errc::io,
               "cannot be written (" + why_not_written(code) +
                   "); is its folder writable and the disk not full?",
               file.string()};
}

}  // namespace weft
