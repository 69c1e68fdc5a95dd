// SPDX-License-Identifier: Apache-2.0
#include "token.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>
#include <weft/core/quote.hpp>

namespace weft::live {
namespace {

/// An open file, closed at the end.
struct OpenFile {
  explicit OpenFile(const std::string& path)
      : descriptor(open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {}
  ~OpenFile() {
    if (descriptor >= 0) close(descriptor);
  }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  const int descriptor;
};

Error unreadable(const std::string& file) {
  return {Errc::io, escaped(file) + " cannot be read: " + std::generic_category().message(errno)};
}

}  // namespace

Result<std::string> token_in(const std::string& file) {
  const OpenFile opened(file);
  struct stat about {};
  // Checks the opened file, not the name, because another file may have that name now.
  if (opened.descriptor < 0 || fstat(opened.descriptor, &about) != 0) return unreadable(file);
  constexpr mode_t kOthers = S_IRWXG | S_IRWXO;
  if (about.st_uid == geteuid() && (about.st_mode & kOthers) != 0) {
    return Error{
        Errc::invalid_value,
        escaped(file) + " can be read by other users; change that: chmod 600 " + escaped(file)};
  }
  constexpr std::size_t kMost = 4096;
  std::string text(kMost, '\0');
  const ssize_t size = read(opened.descriptor, text.data(), text.size());
  if (size < 0) return unreadable(file);
  text.resize(static_cast<std::size_t>(size));
  constexpr const char* kBlank = " \t\r\n";
  const std::size_t begin = text.find_first_not_of(kBlank);
  if (begin == text.npos) return Error{Errc::invalid_value, escaped(file) + " has no token"};
  return text.substr(begin, text.find_last_not_of(kBlank) + 1 - begin);
}

}  // namespace weft::live
