// SPDX-License-Identifier: Apache-2.0
#include "host/workers/process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <filesystem>
#include <weft/core/index.hpp>

#include "host/supervising/supervisor.hpp"

namespace weft::host {
namespace {

constexpr int kPatience_ms = 5000;
constexpr int kSlice_ms = 10;  ///< after which one who waits looks whether it shall go on

std::string beside_this_program() {
  std::error_code code;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", code);
  return (self.parent_path() / "weft-worker").string();
}

/// What the child gets: its three descriptors, nothing of this program's signals or terminal.
class SpawnSettings {
 public:
  SpawnSettings(std::array<int, 3> files, int output) {
    posix_spawn_file_actions_init(&actions_);
    posix_spawn_file_actions_addopen(&actions_, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_adddup2(&actions_, output, STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions_, output, STDERR_FILENO);
    // To itself: the number stays and the descriptor outlives the start of the program.
    for (const int file : files) posix_spawn_file_actions_adddup2(&actions_, file, file);
    posix_spawnattr_init(&attributes_);
    sigset_t none, all;
    sigemptyset(&none);
    sigfillset(&all);
    posix_spawnattr_setsigmask(&attributes_, &none);
    posix_spawnattr_setsigdefault(&attributes_, &all);
    posix_spawnattr_setpgroup(&attributes_, 0);
    posix_spawnattr_setflags(
        &attributes_, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP);
  }
  ~SpawnSettings() {
    posix_spawn_file_actions_destroy(&actions_);
    posix_spawnattr_destroy(&attributes_);
  }
  SpawnSettings(const SpawnSettings&) = delete;
  SpawnSettings& operator=(const SpawnSettings&) = delete;

  int spawn(pid_t& id, std::vector<std::string> words) const {
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    return posix_spawn(&id, arguments[0], &actions_, &attributes_, arguments.data(), environ);
  }

 private:
  posix_spawn_file_actions_t actions_{};
  posix_spawnattr_t attributes_{};
};

}  // namespace

Result<std::unique_ptr<WorkerProcess>> WorkerProcess::start(const std::string& program,
                                                            int inputs_file, int outputs_file) {
  const std::string path = program.empty() ? beside_this_program() : program;
  const auto failed = [&](int code) {
    return Error{Errc::io,
                 "the worker program " + path + " cannot be started: " + strerror(code) +
                     "; build or install weft-worker beside the program that runs the pipeline"};
  };
  std::array<int, 2> ends{-1, -1};
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) return failed(errno);
  auto channel = std::make_unique<Channel>(ends[0]);
  const Channel workers_end(ends[1]);
  const timeval patience{kPatience_ms / 1000, 0};
  setsockopt(ends[0], SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof(patience));
  const timeval slice{0, 1000 * kSlice_ms};
  setsockopt(ends[0], SOL_SOCKET, SO_RCVTIMEO, &slice, sizeof(slice));
  const int output = memfd_create("weft-worker output", MFD_CLOEXEC);
  if (output < 0) return failed(errno);
  fcntl(output, F_SETFL, O_APPEND);
  pid_t id = 0;
  const int code = SpawnSettings({ends[1], inputs_file, outputs_file}, output)
                       .spawn(id, {path, std::to_string(ends[1]), std::to_string(inputs_file),
                                   std::to_string(outputs_file)});
  if (code != 0) {
    close(output);
    return failed(code);
  }
  return std::unique_ptr<WorkerProcess>(new WorkerProcess(id, std::move(channel), output));
}

WorkerProcess::~WorkerProcess() {
  channel_->finish();
  if (!reap(kPatience_ms)) kill();
  close(output_);
}

void WorkerProcess::kill() {
  if (id_ == 0) return;
  status_ = end_supervised(id_);
  id_ = 0;
}

bool WorkerProcess::reap(int patience_ms) {
  for (int waited_ms = 0; id_ != 0; ++waited_ms) {
    const pid_t got = waitpid(id_, &status_, WNOHANG);
    if (got == id_) id_ = 0;
    if (got < 0 && errno != EINTR) {
      status_ = -1;
      id_ = 0;
    }
    if (id_ == 0 || waited_ms >= patience_ms) break;
    poll(nullptr, 0, 1);
  }
  return id_ == 0;
}

Error WorkerProcess::cause_of_death() {
  Error death{Errc::plugin_failure, "closed its connection and was ended", {}};
  if (!reap(kPatience_ms)) {
    kill();
    if (!had_too_many_processes(status_)) return death;
  }
  std::string cause = "ended";
  if (status_ != -1 && had_too_many_processes(status_)) {
    cause = too_many_processes();
  } else if (status_ != -1 && WIFEXITED(status_)) {
    cause = "exited with status " + std::to_string(WEXITSTATUS(status_));
  } else if (status_ != -1 && WIFSIGNALED(status_)) {
    const int signal = WTERMSIG(status_);
    const char* name = sigdescr_np(signal);
    cause = "died of signal " + std::to_string(signal) + " (" + (name != nullptr ? name : "?") +
            ")" + (signal == SIGKILL ? ", perhaps because memory was short" : "");
    if (signal == SIGKILL) death.code = Errc::no_memory;
  }
  const std::string line = last_line();
  death.message = line.empty() ? cause : cause + "; the last that it printed: " + line;
  return death;
}

std::uint64_t WorkerProcess::forget_old_output() {
  constexpr off_t kMost = 1 << 20;
  struct stat status {};
  if (fstat(output_, &status) != 0 || status.st_size <= kMost) return 0;
  return ftruncate(output_, 0) == 0 ? static_cast<std::uint64_t>(status.st_size) : 0;
}

std::string WorkerProcess::last_line() const {
  constexpr std::size_t kLongest = 300;
  struct stat status {};
  if (fstat(output_, &status) != 0) return {};
  std::string text(kLongest, '\0');
  const off_t start = std::max<off_t>(0, status.st_size - static_cast<off_t>(kLongest));
  const ssize_t count = pread(output_, text.data(), text.size(), start);
  text.resize(to_index(std::max<ssize_t>(count, 0)));
  const std::size_t end = text.find_last_not_of(" \t\r\n");
  text.resize(end == std::string::npos ? 0 : end + 1);
  text.erase(0, text.rfind('\n') + 1);  // npos + 1 is 0
  for (char& c : text) {
    if (static_cast<unsigned char>(c) < 0x20) c = ' ';
  }
  return text;
}

}  // namespace weft::host
