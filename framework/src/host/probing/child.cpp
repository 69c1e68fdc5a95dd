// SPDX-License-Identifier: Apache-2.0
#include "host/probing/child.hpp"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <exception>
#include <optional>
#include <weft/core/index.hpp>

#include "host/loading/library_call.hpp"
#include "host/supervising/supervisor.hpp"

namespace weft::host {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kLongestAnswer_bytes = 256 << 20;

/// How an answer goes through a pipe: this, then the texts one behind the other.
struct Header {
  std::int32_t code = 0;  ///< of an Error; 0 for an answer
  std::array<std::uint64_t, 2> sizes{};
};

bool write_all(int pipe, const void* bytes, std::size_t size) {
  const char* next = static_cast<const char*>(bytes);
  while (size > 0) {
    const ssize_t written = write(pipe, next, size);
    if (written < 0 && errno != EINTR) return false;
    if (written < 0) continue;
    next += written;
    size -= to_index(written);
  }
  return true;
}

void send(int pipe, const Result<std::string>& result) {
  Header header;
  const std::string& text = result ? *result : result.error().message;
  const std::string where = result ? std::string() : result.error().where;
  if (!result) header.code = static_cast<std::int32_t>(result.error().code);
  header.sizes = {text.size(), where.size()};
  if (write_all(pipe, &header, sizeof(header)) && write_all(pipe, text.data(), text.size())) {
    write_all(pipe, where.data(), where.size());
  }
}

/// The answer, once all of it is there.
std::optional<Result<std::string>> read_answer(const std::string& bytes) {
  Header header;
  if (bytes.size() < sizeof(header)) return std::nullopt;
  std::memcpy(&header, bytes.data(), sizeof(header));
  const auto& [text, where] = header.sizes;
  const std::size_t rest = bytes.size() - sizeof(header);
  if (text > rest || where > rest - text) return std::nullopt;
  std::string said = bytes.substr(sizeof(header), text);
  if (header.code == 0) return Result<std::string>(std::move(said));
  return Result<std::string>(Error{static_cast<Errc>(header.code), std::move(said),
                                   bytes.substr(sizeof(header) + text, where)});
}

[[noreturn]] void answer_in_child(const std::function<Result<std::string>()>& find_out, int pipe) {
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  go_on_supervised();
  const auto found = [&] {
    const OneProcess one;
    return find_out();
  };
  if (const int nothing = open("/dev/null", O_WRONLY | O_CLOEXEC); nothing >= 0) {
    dup2(nothing, STDOUT_FILENO);
  }
  try {
    send(pipe, found());
  } catch (const std::exception& thrown) {
    send(pipe, Error{Errc::plugin_failure, std::string("throws: ") + thrown.what()});
  } catch (...) {
    send(pipe, Error{Errc::plugin_failure, "throws what is no std::exception"});
  }
  _exit(0);  // whatever libraries do at the end is theirs
}

/// What a copy has sent; it may end, and leave the pipe to others, without having sent anything.
class Child {
 public:
  Child(pid_t process, int pipe) : process_(process), pipe_(pipe) {
    fcntl(pipe_, F_SETFL, O_NONBLOCK);
  }
  ~Child() {
    if (!status_) end_supervised(process_);
    close(pipe_);
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  Result<std::string> answer(Clock::time_point latest, std::chrono::milliseconds longest) {
    while (true) {
      const bool ended = status_.has_value() || wait(WNOHANG);
      read_what_is_there();
      if (auto whole = read_answer(bytes_)) return *std::move(whole);
      if (ended) return Error{Errc::incompatible, how_it_ended()};
      if (bytes_.size() > kLongestAnswer_bytes) {
        return Error{Errc::incompatible, "gives an answer of more than 256 MiB"};
      }
      if (Clock::now() >= latest) {
        const auto seconds = std::chrono::duration<double>(longest).count();
        std::array<char, 64> text;
        std::snprintf(text.data(), text.size(), "does not come to an end within %g s", seconds);
        return Error{Errc::incompatible, text.data()};
      }
      pollfd end{pipe_, POLLIN, 0};
      constexpr int kPause_ms = 5;
      poll(&end, 1, kPause_ms);
      if ((end.revents & POLLIN) == 0) poll(nullptr, 0, kPause_ms);  // closed, and still running
    }
  }

 private:
  bool wait(int flags) {
    int status = 0;
    pid_t ended = 0;
    while ((ended = waitpid(process_, &status, flags)) < 0 && errno == EINTR) {
    }
    if (ended == process_) status_ = status;
    return ended != 0;
  }

  void read_what_is_there() {
    std::array<char, 4096> some;
    for (ssize_t count = 0; bytes_.size() <= kLongestAnswer_bytes &&
                            (count = read(pipe_, some.data(), some.size())) > 0;) {
      bytes_.append(some.data(), to_index(count));
    }
  }

  std::string how_it_ended() const {
    const int status = status_.value_or(0);
    if (had_too_many_processes(status)) return too_many_processes();
    if (!WIFSIGNALED(status)) {
      return "ends the process that loads it by exit(" + std::to_string(WEXITSTATUS(status)) + ")";
    }
    const int signal = WTERMSIG(status);
    return "ends the process that loads it by signal " + std::to_string(signal) + " (" +
           strsignal(signal) + ")";
  }

  pid_t process_;
  int pipe_;
  std::optional<int> status_{};
  std::string bytes_{};
};

}  // namespace

Result<std::string> ask_in_child(const std::function<Result<std::string>()>& find_out,
                                 std::chrono::milliseconds longest) {
  const auto latest = Clock::now() + longest;
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) return Error{Errc::io, "cannot open a pipe"};
  std::fflush(nullptr);  // or what waits to be printed is printed twice
  const pid_t process = fork();
  if (process == 0) {
    close(ends[0]);
    answer_in_child(find_out, ends[1]);
  }
  close(ends[1]);
  if (process < 0) {
    close(ends[0]);
    return Error{Errc::io, std::string("no process can be started: ") + std::strerror(errno)};
  }
  return Child(process, ends[0]).answer(latest, longest);
}

}  // namespace weft::host
