// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <system_error>
#include <utility>
#include <weft/core/index.hpp>
#include <weft/core/result.hpp>

namespace weft {
namespace detail {

/// A file descriptor that is closed at the end of its scope.
class OpenFile {
 public:
  // O_NONBLOCK keeps the open of a FIFO without a writer from blocking forever.
  explicit OpenFile(const std::string& path)
      : descriptor_(::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC)) {}
  ~OpenFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;

  int get() const { return descriptor_; }

 private:
  int descriptor_;
};

/// Appends the rest of a file to `text`, at most `room` bytes. Returns 0 or the errno value. It
/// reads into the capacity of `text` first, because a larger piece costs more than a small file.
inline int append_bytes(int descriptor, std::uint64_t room, std::string& text) {
  constexpr std::size_t kPiece = 1U << 16U;
  while (room > 0) {
    const std::size_t before = text.size();
    const std::size_t left = text.capacity() - before;
    text.resize(before + std::min<std::uint64_t>(room, left > 0 ? left : kPiece));
    const ::ssize_t got = ::read(descriptor, text.data() + before, text.size() - before);
    const int cause = errno;
    text.resize(before + to_index(std::max<::ssize_t>(got, 0)));
    if (got == 0) return 0;
    if (got < 0 && cause != EINTR) return cause;
    room -= text.size() - before;
  }
  return 0;
}

}  // namespace detail

/// Reads the bytes of a regular file of at most `most_bytes` (below 2^64 - 1). The limit applies
/// during the read, so that a file that grows or reports a wrong size cannot exceed it. Fails with
/// Errc::not_found if the file does not exist, else with Errc::io. The message is the reason, such
/// as "there is no such file", "it is a folder" or "Permission denied".
inline Result<std::string> read_text_file(const std::string& path, std::uint64_t most_bytes) {
  const auto fail = [&](Errc code, std::string reason) {
    return Error{code, std::move(reason), path};
  };
  if (path.find('\0') != std::string::npos) return fail(Errc::io, "its name has a NUL character");
  const detail::OpenFile file(path);
  if (file.get() < 0) {
    if (errno == ENOENT || errno == ENOTDIR) return fail(Errc::not_found, "there is no such file");
    return fail(Errc::io,
                errno == ENXIO ? "it is no regular file" : std::generic_category().message(errno));
  }
  struct stat status {};
  if (::fstat(file.get(), &status) != 0) {
    return fail(Errc::io, std::generic_category().message(errno));
  }
  if (S_ISDIR(status.st_mode)) return fail(Errc::io, "it is a folder");
  if (!S_ISREG(status.st_mode)) return fail(Errc::io, "it is no regular file");
  const std::string too_large = "it has more than " + std::to_string(most_bytes) + " bytes";
  const auto size = static_cast<std::uint64_t>(std::max<::off_t>(status.st_size, 0));
  if (size > most_bytes) return fail(Errc::io, too_large);
  std::string text;
  text.reserve(to_index(size) + 1);
  // Kernel files report a size of 0. One byte more than the limit reveals a file that exceeds it.
  if (const int cause = detail::append_bytes(file.get(), most_bytes + 1, text); cause != 0) {
    return fail(Errc::io, std::generic_category().message(cause));
  }
  if (text.size() > most_bytes) return fail(Errc::io, too_large);
  return text;
}

/// Kind of input that a user-given path must lead to.
enum class InputKind { file, folder, any };

/// Fails if a path does not exist or leads to a folder instead of a file, or the reverse. All
/// components use these error messages. `remedy` is the correction, such as "give the folder of a
/// run".
inline Result<void> check_input(const std::string& path, InputKind kind,
                                const std::string& remedy = "correct its name") {
  std::error_code code;
  const auto status = std::filesystem::status(path, code);
  const auto fail = [&](const std::string& what, const std::string& what_to_do) {
    return Error{Errc::not_found, what + "; " + what_to_do, path};
  };
  if (!std::filesystem::exists(status)) {
    const bool hidden =
        code && code != std::errc::no_such_file_or_directory && code != std::errc::not_a_directory;
    if (hidden) return fail("cannot be read: " + code.message(), remedy);
    return fail(kind == InputKind::file     ? "there is no such file"
                : kind == InputKind::folder ? "there is no such folder"
                                            : "there is no such file or folder",
                remedy);
  }
  const bool is_folder = std::filesystem::is_directory(status);
  if (kind == InputKind::file && is_folder) return fail("is a folder, no file", remedy);
  if (kind == InputKind::folder && !is_folder) return fail("is a file, no folder", remedy);
  return {};
}

/// Returns the same message for a file whose text could not be read. `error` comes from
/// read_text_file.
inline std::string unreadable_text(const Error& error) {
  if (auto found = check_input(error.where, InputKind::file); !found) return found.error().message;
  return "cannot be read: " + error.message;
}

}  // namespace weft
