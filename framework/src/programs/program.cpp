// SPDX-License-Identifier: Apache-2.0
#include "programs/program.hpp"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <optional>
#include <weft/core/index.hpp>

namespace weft {
namespace {

/// The two ends of a pipe, closed by its end.
class Pipe {
 public:
  Pipe() { ok_ = pipe2(ends_, O_CLOEXEC) == 0; }
  ~Pipe() {
    close_end(0);
    close_end(1);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;

  explicit operator bool() const { return ok_; }
  int read_end() const { return ends_[0]; }
  int write_end() const { return ends_[1]; }
  void close_end(int which) {
    if (ends_[which] >= 0) close(ends_[which]);
    ends_[which] = -1;
  }

 private:
  int ends_[2] = {-1, -1};
  bool ok_ = false;
};

/// Adds texts and the end of a list as C programs take it.
void add_all(std::vector<std::string>& texts, std::vector<char*>& list) {
  for (std::string& text : texts) list.push_back(text.data());
  list.push_back(nullptr);
}

/// 0, or why the program could not be started.
int start(std::vector<std::string> words, std::vector<std::string> settings, int out, int err,
          pid_t& process) {
  std::vector<char*> arguments, environment;
  add_all(words, arguments);
  for (char** each = environ; *each != nullptr; ++each) environment.push_back(*each);
  add_all(settings, environment);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, out, STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, err, STDERR_FILENO);
  const int failure =
      posix_spawnp(&process, arguments[0], &actions, nullptr, arguments.data(), environment.data());
  posix_spawn_file_actions_destroy(&actions);
  return failure;
}

/// False at the end. What is too much is read, so that the program goes on, and not kept.
bool append(int end, std::string& text) {
  constexpr std::size_t kMostKept_bytes = 64 << 20;
  char bytes[4096];
  const ssize_t count = read(end, bytes, sizeof(bytes));
  if (count < 0) return errno == EINTR;
  if (text.size() < kMostKept_bytes) text.append(bytes, to_index(count));
  return count > 0;
}

/// When a program is to be ended; never where it may take as long as it likes.
class Deadline {
 public:
  explicit Deadline(std::chrono::milliseconds longest)
      : end_(longest.count() > 0 ? std::optional(Clock::now() + longest) : std::nullopt) {}

  /// [ms] as poll() takes it: -1 for ever.
  int left_ms() const {
    if (!end_) return -1;
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(*end_ - Clock::now());
    return static_cast<int>(std::max<std::int64_t>(left.count(), 0));
  }
  bool is_over() const { return left_ms() == 0; }

 private:
  using Clock = std::chrono::steady_clock;
  std::optional<Clock::time_point> end_;
};

/// Until both ends are closed, the program has ended or it is too late. What a program has started
/// may hold the ends for as long as it likes. Nothing while the program runs, else its status.
std::optional<int> read_both(const Pipe& out, const Pipe& err, pid_t process,
                             const Deadline& deadline, Answer& answer) {
  constexpr int kPause_ms = 20;
  pollfd ends[] = {{out.read_end(), POLLIN, 0}, {err.read_end(), POLLIN, 0}};
  std::optional<int> ended;
  int reads_after_end = 64;  // of all that pipes can hold, and not of what others go on to write
  while ((ends[0].fd >= 0 || ends[1].fd >= 0) && !deadline.is_over()) {
    const int left_ms = deadline.left_ms();
    const int longest_ms = left_ms < 0 ? kPause_ms : std::min(left_ms, kPause_ms);
    const int ready = poll(ends, 2, ended ? 0 : longest_ms);
    if (ready < 0 && errno != EINTR) return ended;
    if (ended && (ready == 0 || --reads_after_end == 0)) return ended;
    int status = 0;
    if (!ended && waitpid(process, &status, WNOHANG) == process) ended = status;
    if (ready <= 0) continue;
    if (ends[0].revents != 0 && !append(ends[0].fd, answer.out)) ends[0].fd = -1;
    if (ends[1].revents != 0 && !append(ends[1].fd, answer.err)) ends[1].fd = -1;
  }
  return ended;
}

/// Waits for its end, or ends it where it is too late. Its status.
int wait_for(pid_t process, const Deadline& deadline, Answer& answer) {
  constexpr int kPause_ms = 5;
  int status = 0;
  while (deadline.left_ms() >= 0) {  // else there is none, and nothing but the end to wait for
    if (waitpid(process, &status, WNOHANG) == process) return status;
    if (deadline.is_over()) {
      answer.late = true;
      kill(process, SIGKILL);
      break;
    }
    poll(nullptr, 0, kPause_ms);
  }
  while (waitpid(process, &status, 0) < 0 && errno == EINTR) {
  }
  return status;
}

}  // namespace

Result<Answer> run_program(const std::vector<std::string>& words,
                           const std::vector<std::string>& settings,
                           std::chrono::milliseconds longest) {
  const Deadline deadline(longest);
  Pipe out, err;
  if (!out || !err) return Error{Errc::io, "cannot open a pipe"};
  pid_t process = 0;
  if (const int failure = start(words, settings, out.write_end(), err.write_end(), process);
      failure != 0) {
    return Error{failure == ENOENT ? Errc::not_found : Errc::io,
                 std::string("cannot be started: ") + std::strerror(failure), words.front()};
  }
  out.close_end(1);
  err.close_end(1);
  Answer answer;
  const auto ended = read_both(out, err, process, deadline, answer);
  const int status = ended ? *ended : wait_for(process, deadline, answer);
  answer.exit_code = WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
  return answer;
}

}  // namespace weft
