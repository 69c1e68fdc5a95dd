// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>
#include <poll.h>

#include <algorithm>
#include <chrono>
#include <deque>
#include <list>
#include <map>
#include <optional>
#include <weft/core/index.hpp>

#include "lab/ablation/engine.hpp"
#include "lab/ablation/local_child.hpp"
#include "lab/results/cell_record.hpp"

namespace weft::lab {
namespace {

using Cells = std::vector<const Cell*>;
using Clock = std::chrono::steady_clock;

constexpr int kMostKills = 3;  ///< kills of one task, before it is left
constexpr int kPause_ms = 200, kPauseAtEnd_ms = 2;

/// Cells that one process is to run.
struct Task {
  Cells cells;
  int kills = 0;  ///< how often its process was killed from outside
};

/// A process at work.
struct Child {
  std::unique_ptr<process::Child> process;
  Task task;
  double share = 0.0;                       ///< share of its frames
  std::string error;                        ///< why it gave up
  std::map<std::string, std::string> left;  ///< why cells have no result, by key
  bool no_memory = false;
  bool done = false;      ///< it has kept all results
  double silent_s = 0.0;  ///< since its last message
  bool ended = false;     ///< by this program, as it sent no message until its deadline
};

class LocalRun {
 public:
  LocalRun(const Order& order, const Engine::Progress& progress, const std::atomic<bool>& cancel,
           int jobs)
      : order_(order), progress_(progress), cancel_(cancel), jobs_(jobs) {
    for (const Cells& group : order.groups) {
      tasks_.push_back({group, 0});
      cells_ += group.size();
    }
  }
  ~LocalRun() {
    for (const Child& child : children_) child.process->ask_to_end();  // all at once
  }
  LocalRun(const LocalRun&) = delete;
  LocalRun& operator=(const LocalRun&) = delete;

  Result<std::vector<std::string>> run() {
    while ((!tasks_.empty() || !children_.empty()) && !cancel_.load()) {
      while (!tasks_.empty() && children_.size() < to_index(jobs_)) {
        if (auto started = start(); !started) return started.error();
      }
      if (auto heard = listen(); !heard) return heard.error();
      report();
    }
    return std::move(left_);
  }

 private:
  Result<void> start() {
    Child child;
    child.task = std::move(tasks_.front());
    tasks_.pop_front();
    auto process = start_child(order_, child.task.cells);
    if (!process) return process.error();
    child.process = *std::move(process);
    children_.push_back(std::move(child));
    return {};
  }

  /// Waits for messages of the children, or for a moment.
  Result<void> listen() {
    std::vector<pollfd> pipes;
    bool is_one_ending = false;
    for (const Child& child : children_) {
      pipes.push_back({child.process->out_file(), POLLIN, 0});
      is_one_ending = is_one_ending || pipes.back().fd < 0;
    }
    const auto before = Clock::now();
    poll(pipes.data(), pipes.size(), is_one_ending ? kPauseAtEnd_ms : kPause_ms);
    const auto waited = Clock::now() - before;
    auto done = hear_all();
    end_silent(waited);
    return done;
  }

  /// A process has ended when it exits, even if others hold its pipe, and not when it closes the
  /// pipe.
  Result<void> hear_all() {
    for (auto child = children_.begin(); child != children_.end();) {
      const bool ended = child->process->ending().has_value();
      hear(*child);
      if (!ended) {
        ++child;
        continue;
      }
      Child gone = std::move(*child);
      child = children_.erase(child);
      if (auto done = bury(gone); !done) return done;
    }
    return {};
  }

  /// Ends processes in which a cell works past its deadline. A pause of this program, which its
  /// children share if all are stopped at once, counts for a moment only.
  void end_silent(Clock::duration waited) {
    const double deadline_s = order_.grid.plan().measurement.deadline_s;
    const std::chrono::duration<double> longest = std::chrono::milliseconds(2 * kPause_ms);
    for (Child& child : children_) {
      child.silent_s += std::min<std::chrono::duration<double>>(waited, longest).count();
      if (deadline_s <= 0.0 || child.silent_s <= deadline_s || child.ended) continue;
      child.ended = true;
      child.process->ask_to_end();  // its supervisor ends all
    }
  }

  static void hear(Child& child) {
    if (child.process->read()) child.silent_s = 0.0;
    std::string& said = child.process->out();
    for (std::size_t end = said.find('\n'); end != std::string::npos; end = said.find('\n')) {
      const auto heard = parse_message(said.substr(0, end));
      said.erase(0, end + 1);
      if (heard.share) child.share = *heard.share;
      if (!heard.error.empty()) child.error = heard.error;
      if (heard.left) child.left.insert(*heard.left);
      child.no_memory = child.no_memory || heard.no_memory;
      child.done = child.done || heard.done;
    }
  }

  Result<void> bury(Child& child) {
    const process::Ending ending = *child.process->ending();
    leave(child.task, child.left);
    if (child.done) {
      done_ += static_cast<double>(child.task.cells.size());
      return {};
    }
    if (!child.error.empty()) return Error{Errc::io, child.error};
    if (auto rest = leave_out_finished(child.task); !rest) return rest;
    if (child.task.cells.empty()) return {};
    if (child.ended) return blame(std::move(child.task), past_deadline());
    if (child.no_memory) return try_again(std::move(child.task), "there was not enough memory");
    return is_own_fault(ending) ? blame(std::move(child.task), how_it_ended(ending))
                                : try_again(std::move(child.task), how_it_ended(ending));
  }

  std::string past_deadline() const {
    return fmt::format("it did not end a call within its deadline (deadline_s: {:g})",
                       order_.grid.plan().measurement.deadline_s);
  }

  void leave(Task& task, const std::map<std::string, std::string>& reasons) {
    std::erase_if(task.cells, [&](const Cell* cell) {
      const auto reason = reasons.find(cell->identity.key);
      if (reason != reasons.end()) leave(*cell, reason->second);
      return reason != reasons.end();
    });
  }
  void leave(const Cell& cell, const std::string& reason) {
    done_ += 1.0;
    left_.push_back("the cell " + cell.identity.key + ": " + reason);
  }

  Result<void> leave_out_finished(Task& task) {
    const auto stored = read_cell_records(order_.folder.path(), {{}, false, false, false});
    if (!stored) return stored.error();
    const auto finished = [&](const Cell* cell) {
      const auto found = stored->cells.find(cell->identity.key);
      return found != stored->cells.end() && (found->second.timed || !order_.timed);
    };
    done_ += static_cast<double>(std::erase_if(task.cells, finished));
    return {};
  }

  /// One of several cells did it: each is run alone. A cell that was alone has failed.
  Result<void> blame(Task task, const std::string& how) {
    if (task.cells.size() > 1) {
      split(task);
      return {};
    }
    Cell cell = *task.cells.front();
    CellResult result;
    result.failure = how;
    auto [pipeline, report] = order_.grid.load(cell);
    const std::string changed =
        report.ok() ? order_.grid.changed_input(pipeline) : "\n" + report.text();
    if (!changed.empty()) {
      leave(cell, result.failure + "; its data changed while it ran: " + changed);
      return {};
    }
    result.pipeline = effective_yaml(pipeline.config);
    cell.identity.stages = order_.grid.stage_keys(pipeline);
    if (!lines_) {
      auto lines = order_.folder.writer(order_.timed);
      if (!lines) return lines.error();
      lines_.emplace(*std::move(lines));
    }
    done_ += 1.0;
    return order_.folder.keep(cell, result, order_.timed, order_.grid.plan().measurement, *lines_);
  }

  /// The cause of death is unrelated to the cells, unless they want more memory than there is.
  Result<void> try_again(Task task, const std::string& how) {
    if (++task.kills < kMostKills) {
      tasks_.push_front(std::move(task));
    } else if (task.cells.size() > 1) {
      split(task);
    } else {
      leave(*task.cells.front(),
            how + ", " + std::to_string(kMostKills) + " times; is there enough memory?");
    }
    return {};
  }

  void split(const Task& task) {
    for (auto cell = task.cells.rbegin(); cell != task.cells.rend(); ++cell) {
      tasks_.push_front({{*cell}, 0});
    }
  }

  void report() const {
    double done = done_;
    for (const Child& child : children_) {
      done += child.share * static_cast<double>(child.task.cells.size());
    }
    progress_(done / static_cast<double>(cells_));
  }

  const Order& order_;
  const Engine::Progress& progress_;
  const std::atomic<bool>& cancel_;
  int jobs_;
  std::deque<Task> tasks_;
  std::list<Child> children_;
  std::optional<LineWriter> lines_;  ///< lines of cells that died, from the first one on
  std::vector<std::string> left_;
  std::size_t cells_ = 0;
  double done_ = 0.0;  ///< [cells]
};

class LocalEngine final : public Engine {
 public:
  explicit LocalEngine(int jobs) : jobs_(jobs) {}

  Result<std::vector<std::string>> run(const Order& order, const Progress& progress,
                                       const std::atomic<bool>& cancel) override {
    return LocalRun(order, progress, cancel, jobs_).run();
  }

 private:
  int jobs_;
};

}  // namespace

std::unique_ptr<Engine> local_engine(int jobs) { return std::make_unique<LocalEngine>(jobs); }

}  // namespace weft::lab
