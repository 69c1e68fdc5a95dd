// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <climits>
#include <ctime>
#include <filesystem>
#include <limits>
#include <weft/core/whole_file.hpp>

#include "outlet.hpp"

namespace weft::stream {
namespace {

/// During its lifetime, a write of this thread into a pipe without a reader returns an error
/// instead of ending the process.
class NoPipeSignal {
 public:
  NoPipeSignal() {
    sigemptyset(&pipe_);
    sigaddset(&pipe_, SIGPIPE);
    pthread_sigmask(SIG_BLOCK, &pipe_, &before_);
  }
  ~NoPipeSignal() {
    if (sigismember(&before_, SIGPIPE) != 0) return;
    const std::timespec now{};
    while (sigtimedwait(&pipe_, nullptr, &now) < 0 && errno == EINTR) continue;
    pthread_sigmask(SIG_SETMASK, &before_, nullptr);
  }
  NoPipeSignal(const NoPipeSignal&) = delete;
  NoPipeSignal& operator=(const NoPipeSignal&) = delete;

 private:
  sigset_t pipe_{}, before_{};
};

Error cannot_write(const std::string& path, int reason) {
  if (reason == EPIPE) {
    return {Errc::io,
            "no process reads " + path + " any more: keep its reader running, or write a file",
            {}};
  }
  const std::error_code code(reason, std::generic_category());
  return {Errc::io,
          path + " cannot be written (" + why_not_written(code) + "): choose another 'path'",
          {}};
}

class PathOutlet final : public Outlet {
 public:
  PathOutlet(int file, std::string path) : file_(file), path_(std::move(path)) {
    struct stat status {};
    const bool is_file = fstat(file, &status) == 0 && S_ISREG(status.st_mode);
    if (!is_file) most_at_once_ = PIPE_BUF;
  }
  ~PathOutlet() override { close(file_); }
  PathOutlet(const PathOutlet&) = delete;
  PathOutlet& operator=(const PathOutlet&) = delete;

  Result<void> send(std::string message, const Call& call) override {
    // After a part of a message no reader finds the next one.
    if (status_) status_ = write_all(message, call);
    return status_;
  }

  void finish() override {}

 private:
  Result<void> write_all(std::string_view bytes, const Call& call) const {
    constexpr int kAskEveryMs = 4;
    const NoPipeSignal guard;
    while (!bytes.empty()) {
      pollfd place{file_, POLLOUT, 0};
      const int ready = poll(&place, 1, kAskEveryMs);
      if (ready == 0 && call.cancelled())
        return Error{Errc::cancelled, "no process reads " + path_};
      if (ready <= 0) continue;
      const ssize_t written = ::write(file_, bytes.data(), std::min(bytes.size(), most_at_once_));
      if (written < 0 && errno != EINTR && errno != EAGAIN) return cannot_write(path_, errno);
      if (written > 0) bytes.remove_prefix(static_cast<std::size_t>(written));
    }
    return {};
  }

  int file_;
  std::string path_;
  /// A pipe that is ready has room for this many bytes: larger writes would block.
  std::size_t most_at_once_ = std::numeric_limits<std::size_t>::max();
  Result<void> status_;
};

}  // namespace

MadeOutlet open_path(const std::string& path) {
  int file = -1;
  if (path == "/dev/stdout") {
    // Opened by its name a file would be written from its beginning.
    file = fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
  } else {
    std::error_code ignored;  // open() reports a missing folder
    std::filesystem::create_directories(std::filesystem::path(path).parent_path(), ignored);
    file = open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_NONBLOCK | O_CLOEXEC, 0666);
  }
  if (file >= 0) return std::unique_ptr<Outlet>(std::make_unique<PathOutlet>(file, path));
  if (errno == ENXIO) {
    return Error{Errc::io, "no process reads the named pipe " + path + ": start its reader first"};
  }
  return cannot_write(path, errno);
}

}  // namespace weft::stream
