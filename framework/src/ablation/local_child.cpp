// SPDX-License-Identifier: Apache-2.0
#include "ablation/local_child.hpp"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <new>

#include "host/supervising/supervisor.hpp"
#include "results/cell_line.hpp"

namespace weft::evaluation {
namespace {

/// Keeps results and tells the parent how far it is.
class Reporter final : public GroupObserver {
 public:
  Reporter(const Order& order, int pipe) : order_(order), pipe_(pipe) {}

  void cell_works() override {
    if (order_.grid.plan().measurement.deadline_s > 0.0) say("w");
  }

  void frame_done(std::int64_t done, std::int64_t frames) override {
    if (frames <= 0) return;
    say("p" + std::to_string(static_cast<double>(done) / static_cast<double>(frames)));
  }

  Result<void> cell_done(const Cell& cell, const CellResult& result) override {
    if (!lines_) {
      auto lines = order_.folder.writer(order_.timed);
      if (!lines) return lines.error();
      lines_.emplace(*std::move(lines));
    }
    return order_.folder.keep(cell, result, order_.timed, order_.grid.plan().measurement, *lines_);
  }

  void cell_left(const Cell& cell, const std::string& reason) override {
    say("l" + cell.identity.key + reason);
  }

  void say(std::string text) const {
    std::replace(text.begin(), text.end(), '\n', ' ');
    text += '\n';
    // Without a listener there is nothing to be said, and this process is about to end.
    static_cast<void>(!write(pipe_, text.data(), text.size()));
  }

 private:
  const Order& order_;
  int pipe_;
  std::optional<LineWriter> lines_;
};

/// What happened is said, and not left to the exit code, which components may choose too.
void run_cells(const Order& order, const std::vector<const Cell*>& cells, int pipe) {
  Reporter reporter(order, pipe);
  Result<void> done;
  try {
    done = run_group(order.grid, cells, reporter);
  } catch (const std::bad_alloc&) {
    return reporter.say("m");
  } catch (const std::exception& failure) {
    done = Error{Errc::io, std::string("the host failed: ") + failure.what()};
  }
  if (done) return reporter.say("d");
  const Error& error = done.error();
  reporter.say("e" + (error.where.empty() ? "" : error.where + ": ") + error.message);
}

void print_into(const std::string& file) {
  const int log = open(file.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  if (log < 0) return;
  dup2(log, STDOUT_FILENO);
  dup2(log, STDERR_FILENO);
  close(log);
}

}  // namespace

Result<ChildProcess> start_child(const Order& order, const std::vector<const Cell*>& cells) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) return Error{Errc::io, "cannot open a pipe"};
  const pid_t parent = getpid();
  const pid_t child = fork();
  if (child < 0) {
    close(ends[0]);
    close(ends[1]);
    return Error{Errc::io, std::string("cannot start a process: ") + std::strerror(errno)};
  }
  if (child > 0) {
    close(ends[1]);
    fcntl(ends[0], F_SETFL, O_NONBLOCK);
    return ChildProcess{child, ends[0]};
  }
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (getppid() != parent) _exit(1);
  host::go_on_supervised();
  close(ends[0]);
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, SIG_DFL);
  print_into(order.folder.log_file());
  run_cells(order, cells, ends[1]);
  _exit(0);
}

bool is_own_fault(int status) {
  if (!WIFSIGNALED(status)) return true;
  constexpr int kFaults[] = {SIGSEGV, SIGABRT, SIGBUS, SIGFPE, SIGILL, SIGSYS, SIGTRAP};
  return std::find(std::begin(kFaults), std::end(kFaults), WTERMSIG(status)) != std::end(kFaults);
}

std::string how_it_ended(int status) {
  if (host::had_too_many_processes(status)) return "it " + host::too_many_processes();
  if (WIFSIGNALED(status)) {
    const int signal = WTERMSIG(status);
    return "its process died of signal " + std::to_string(signal) + " (" + strsignal(signal) + ")";
  }
  return "it ended its process with exit code " + std::to_string(WEXITSTATUS(status));
}

ChildMessage parse_message(const std::string& line) {
  ChildMessage message;
  if (line.starts_with("p")) message.share = std::atof(line.c_str() + 1);
  if (line.starts_with("e")) message.error = line.substr(1);
  if (line.starts_with("l") && line.size() > kKeyDigits) {
    message.left = {line.substr(1, kKeyDigits), line.substr(1 + kKeyDigits)};
  }
  message.no_memory = line == "m";
  message.done = line == "d";
  return message;
}

}  // namespace weft::evaluation
