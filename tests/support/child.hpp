// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>

#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <vector>

extern char** environ;

namespace weft::testing {

/// How a program ended, and what it printed.
struct Ended {
  int exit_code = -1;  ///< -1 when a signal ended it
  int signal = 0;
  std::string out, err;
};

/// A program that runs beside the test; it is killed when the test forgets it.
class Child {
 public:
  /// `command` begins with the program; `scratch` is a path to which suffixes are added.
  Child(std::vector<std::string> command, std::string scratch) : scratch_(std::move(scratch)) {
    std::vector<char*> arguments;
    for (std::string& word : command) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    constexpr int kFlags = O_WRONLY | O_CREAT | O_TRUNC;
    posix_spawn_file_actions_addopen(&actions, 1, (scratch_ + ".out").c_str(), kFlags, 0600);
    posix_spawn_file_actions_addopen(&actions, 2, (scratch_ + ".err").c_str(), kFlags, 0600);
    const int failed =
        posix_spawn(&process_, arguments[0], &actions, nullptr, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    if (failed != 0) throw std::runtime_error("cannot start " + command[0]);
  }
  ~Child() {
    if (process_ <= 0) return;
    send(SIGKILL);
    waitpid(process_, nullptr, 0);
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  void send(int signal) const { kill(process_, signal); }

  /// 0 once it was waited for.
  pid_t id() const { return process_; }

  Ended wait() {
    int status = 0;
    waitpid(process_, &status, 0);
    process_ = 0;
    Ended ended;
    if (WIFEXITED(status)) ended.exit_code = WEXITSTATUS(status);
    if (WIFSIGNALED(status)) ended.signal = WTERMSIG(status);
    ended.out = read(scratch_ + ".out");
    ended.err = read(scratch_ + ".err");
    return ended;
  }

 private:
  static std::string read(const std::string& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  }

  std::string scratch_;
  pid_t process_ = 0;
};

}  // namespace weft::testing
