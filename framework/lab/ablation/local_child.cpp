// SPDX-License-Identifier: Apache-2.0
#include "lab/ablation/local_child.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <exception>
#include <new>

#include "lab/results/cell_line.hpp"

namespace weft::lab {
namespace {

/// Keeps results and reports its progress to the parent.
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
    // Without a listener there is nothing to report, and this process is about to end.
    static_cast<void>(!write(pipe_, text.data(), text.size()));
  }

 private:
  const Order& order_;
  int pipe_;
  std::optional<LineWriter> lines_;
};

/// Reports the outcome instead of using the exit code, which components may set too.
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

}  // namespace

Result<std::unique_ptr<process::Child>> start_child(const Order& order,
                                                    const std::vector<const Cell*>& cells) {
  const process::OpenFile log(
      open(order.folder.log_file().c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666));
  const auto work = [&](int pipe) {
    run_cells(order, cells, pipe);
    return 0;
  };
  return process::Child::start(process::Copy{work, log.get(), log.get()});
}

bool is_own_fault(const process::Ending& ending) {
  // 0: it ended by itself.
  constexpr int kFaults[] = {0, SIGSEGV, SIGABRT, SIGBUS, SIGFPE, SIGILL, SIGSYS, SIGTRAP};
  return std::find(std::begin(kFaults), std::end(kFaults), ending.signal) != std::end(kFaults);
}

std::string how_it_ended(const process::Ending& ending) {
  if (ending.too_many) return "it " + process::too_many_processes();
  if (ending.signal != 0) return "its process died of " + process::signal_text(ending.signal);
  return "it ended its process with exit code " + std::to_string(ending.exit_code);
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

}  // namespace weft::lab
