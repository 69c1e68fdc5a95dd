// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <filesystem>
#include <string_view>
#include <weft/core/index.hpp>

#include "bench/counts.hpp"

namespace weft::bench {
namespace {

constexpr int kLook_ms = 100, kPatience_ms = 5000;
constexpr std::string_view kPreload = "LD_PRELOAD=";

std::vector<char*> pointers_to(std::vector<std::string>& words) {
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  return pointers;
}

/// This process's own, with the library before others that are loaded first.
std::vector<std::string> environment_with(const std::string& library) {
  std::vector<std::string> all;
  std::string first = std::string(kPreload) + library;
  for (char** each = environ; *each != nullptr; ++each) {
    const std::string_view variable = *each;
    if (variable.starts_with(kPreload)) {
      first += ":" + std::string(variable.substr(kPreload.size()));
    } else {
      all.emplace_back(variable);
    }
  }
  if (!library.empty()) all.push_back(first);
  return all;
}

/// A running program whose output is read; it is ended when it is forgotten.
class Counter {
 public:
  static Result<std::unique_ptr<Counter>> start(std::vector<std::string> command,
                                                const std::string& library) {
    std::array<int, 2> ends{};
    if (pipe2(ends.data(), O_CLOEXEC) != 0) return Error{Errc::io, strerror(errno), "a pipe"};
    std::vector<std::string> variables = environment_with(library);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
    pid_t id = 0;
    const int failed = posix_spawn(&id, command.front().c_str(), &actions, nullptr,
                                   pointers_to(command).data(), pointers_to(variables).data());
    posix_spawn_file_actions_destroy(&actions);
    close(ends[1]);
    if (failed != 0) {
      close(ends[0]);
      return Error{Errc::io, strerror(failed), command.front()};
    }
    return std::unique_ptr<Counter>(new Counter(id, ends[0]));
  }
  ~Counter() {
    close(output_);
    // Asked once it takes away what its sinks have written; a component may be deaf to that.
    for (int looks = 0; id_ != 0 && looks < kPatience_ms / kLook_ms; ++looks) {
      if (looks == 0) kill(id_, SIGTERM);
      if (waitpid(id_, nullptr, WNOHANG) == id_) return;
      poll(nullptr, 0, kLook_ms);
    }
    if (id_ == 0) return;
    kill(id_, SIGKILL);
    waitpid(id_, nullptr, 0);
  }
  Counter(const Counter&) = delete;
  Counter& operator=(const Counter&) = delete;

  /// All that it prints until it ends, whoever holds its output then; less when it is cancelled.
  std::string read_all(const std::atomic<bool>& cancel) {
    std::string text;
    std::array<char, 4096> part{};
    while (!cancel.load()) {
      pollfd waiting{output_, POLLIN, 0};
      const bool ended = has_ended();
      if (poll(&waiting, 1, ended ? 0 : kLook_ms) <= 0) {
        if (ended) break;
        continue;
      }
      const ssize_t count = read(output_, part.data(), part.size());
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) break;
      text.append(part.data(), to_index(count));
    }
    return text;
  }

  /// Whether it ended by itself, with exit code 0.
  bool succeeded() {
    while (!has_ended()) poll(nullptr, 0, 1);
    return WIFEXITED(status_) && WEXITSTATUS(status_) == 0;
  }

 private:
  bool has_ended() {
    const pid_t ended = id_ != 0 ? waitpid(id_, &status_, WNOHANG) : 0;
    if (ended == id_ || (ended < 0 && errno == ECHILD)) id_ = 0;
    return id_ == 0;
  }

  Counter(pid_t id, int output) : id_(id), output_(output) {}
  pid_t id_;  ///< 0 once it has ended
  int output_;
  int status_ = 0;
};

}  // namespace

Result<Counts> count_apart(const std::vector<std::string>& command, const std::string& library,
                           const std::atomic<bool>& cancel) {
  std::error_code code;
  const auto counter =
      Counter::start(command, std::filesystem::exists(library, code) ? library : "");
  if (!counter) return counter.error();
  const std::string text = (*counter)->read_all(cancel);
  if (cancel.load()) return Error{Errc::cancelled, "cancelled", {}};
  if (!(*counter)->succeeded()) return Error{Errc::io, "the process that counts failed", {}};
  return counts_in(text);
}

}  // namespace weft::bench
