// SPDX-License-Identifier: Apache-2.0
#include "lab/cluster/task.hpp"

#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <filesystem>
#include <map>
#include <set>
#include <weft/core/index.hpp>
#include <weft/core/quote.hpp>

#include "lab/ablation/engine.hpp"
#include "lab/cluster/claims.hpp"
#include "lab/results/cell_record.hpp"

namespace weft::cluster {
namespace {

namespace fs = std::filesystem;
using lab::Cell;
using Clock = std::chrono::steady_clock;

std::string machine_name() {
  char name[256] = {};
  return gethostname(name, sizeof(name) - 1) == 0 ? escaped(name) : "a machine without a name";
}

Result<std::set<std::string>> finished_keys(const std::string& results, bool timed) {
  const auto stored = lab::read_cell_records(results, {{}, false, false, false});
  if (!stored) return stored.error();
  std::set<std::string> keys;
  for (const auto& [key, record] : stored->cells) {
    if (record.timed || !timed) keys.insert(key);
  }
  return keys;
}

/// Cells that a task holds, until its end.
class OwnedClaims {
 public:
  OwnedClaims(const Claims& claims, std::string task) : claims_(claims), task_(std::move(task)) {}
  ~OwnedClaims() {
    for (const std::string& key : keys_) claims_.release(key, task_);
  }
  OwnedClaims(const OwnedClaims&) = delete;
  OwnedClaims& operator=(const OwnedClaims&) = delete;

  /// The task that has it, this one or another.
  Result<std::string> take(const std::string& key) {
    auto owner = claims_.take(key, task_);
    if (owner && *owner == task_) keys_.push_back(key);
    return owner;
  }
  std::size_t count(const std::set<std::string>& finished) const {
    const auto is_finished = [&](const std::string& key) { return finished.count(key) > 0; };
    return to_index(std::count_if(keys_.begin(), keys_.end(), is_finished));
  }

 private:
  const Claims& claims_;
  std::string task_;
  std::vector<std::string> keys_;
};

/// One task at work.
class Task {
 public:
  Task(const lab::Grid& grid, const TaskId& id, const Submission& submission, bool timed)
      : grid_(grid), id_(id), submission_(submission), timed_(timed) {
    for (const Cell& cell : grid.cells()) cells_.emplace(cell.identity.key, &cell);
  }

  Result<void> run(const std::string& results, int processes, const std::atomic<bool>& cancel,
                   TaskReport& report) {
    const auto claims = Claims::open(results);
    if (!claims) return claims.error();
    // A task that was put into the queue again may still run on a machine that was thought lost.
    const std::string work =
        claims->work_of(id_.slurm) + "/" + machine_name() + "-" + std::to_string(getpid());
    const auto folder = lab::ResultsFolder::join(results, grid_.plan().name,
                                                 {id_.slurm, work, submission_.log_of(id_.task)});
    if (!folder) return folder.error();
    OwnedClaims owned(*claims, id_.slurm);
    auto groups = claim(owned, report.left);
    if (!groups) return groups.error();
    auto finished = finished_keys(results, timed_);
    if (!finished) return finished.error();
    drop(*finished, *groups);
    const std::size_t before = owned.count(*finished);
    const lab::Order order{grid_, *folder, *std::move(groups), timed_};
    auto left = lab::local_engine(processes)->run(
        order, [](double) {}, cancel);
    if (!left) return left.error();
    report.left.insert(report.left.end(), left->begin(), left->end());
    if (cancel) report.left.emplace_back("the task was ended from outside");
    finished = finished_keys(results, timed_);
    if (!finished) return finished.error();
    report.cells = owned.count(*finished) - before;
    std::error_code code;
    fs::remove_all(work, code);
    return {};
  }

 private:
  using Groups = std::vector<std::vector<const Cell*>>;

  Result<Groups> claim(OwnedClaims& owned, std::vector<std::string>& left) const {
    Groups groups;
    std::size_t unknown = 0;
    std::map<std::string, std::size_t> of_others;  // by task
    for (const Group& keys : submission_.tasks[to_index(id_.task)]) {
      groups.emplace_back();
      for (const std::string& key : keys) {
        const auto known = cells_.find(key);
        if (known == cells_.end()) {
          ++unknown;
          continue;
        }
        const auto owner = owned.take(key);
        if (!owner) return owner.error();
        if (*owner == id_.slurm) groups.back().push_back(known->second);
        if (*owner != id_.slurm) ++of_others[*owner];
      }
    }
    for (const auto& [task, cells] : of_others) {
      left.push_back(std::to_string(cells) + " cells: task " + task + " has them");
    }
    if (unknown > 0) {
      left.push_back(std::to_string(unknown) + " cells have other keys here: " + why_another_key());
    }
    return groups;
  }

  std::string why_another_key() const {
    const std::string difference =
        submission_.equipment.difference(Equipment::here(grid_.registry()));
    return difference.empty() ? "the plan, its pipeline or its data are not what they were"
                              : difference +
                                    "; choose machines that are alike (--partition, "
                                    "--sbatch=--constraint=...), or submit from such a one";
  }

  static void drop(const std::set<std::string>& finished, Groups& groups) {
    for (auto& group : groups) {
      std::erase_if(group,
                    [&](const Cell* cell) { return finished.count(cell->identity.key) > 0; });
    }
    std::erase_if(groups, [](const auto& group) { return group.empty(); });
  }

  const lab::Grid& grid_;
  const TaskId& id_;
  const Submission& submission_;
  bool timed_;
  std::map<std::string, const Cell*> cells_;
};

Result<Submission> submission_of(const std::string& results, const TaskId& id) {
  auto submission = read_submission(results, id.submission);
  if (!submission) return submission;
  if (id.task < static_cast<int>(submission->tasks.size())) return submission;
  return Error{Errc::invalid_value, "has no task " + std::to_string(id.task), submission->folder};
}

}  // namespace

Result<TaskId> task_id(const std::string& text) {
  const std::size_t slash = text.find('/'), line = text.find('_');
  constexpr const char* kDigits = "0123456789";
  if (slash != std::string::npos && line != std::string::npos && slash < line) {
    TaskId id{text.substr(0, slash), text.substr(slash + 1), 0};
    const char* end = text.data() + text.size();
    const auto [stop, failure] = std::from_chars(text.data() + line + 1, end, id.task);
    const bool digits =
        id.submission.find_first_not_of(kDigits) == std::string::npos &&
        text.substr(slash + 1, line - slash - 1).find_first_not_of(kDigits) == std::string::npos;
    if (digits && failure == std::errc() && stop == end && id.task >= 0) return id;
  }
  return Error{Errc::invalid_value, "no task of a submission: " + quote(text)};
}

Result<TaskReport> run_task(const lab::Grid& grid, const std::string& results, const TaskId& id,
                            int processes, bool timed, const std::atomic<bool>& cancel) {
  const auto submission = submission_of(results, id);
  if (!submission) return submission.error();
  TaskReport report{machine_name(), 0.0, 0, {}};
  const auto start = Clock::now();
  const auto done = Task(grid, id, *submission, timed).run(results, processes, cancel, report);
  report.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  if (!done) {
    const Error& error = done.error();
    report.left.push_back((error.where.empty() ? "" : error.where + ": ") + error.message);
  }
  if (auto written = write_report(*submission, id.task, report); !written) return written.error();
  if (!done) return done.error();
  return report;
}

Result<void> report_failure(const std::string& results, const TaskId& id,
                            const std::string& reason) {
  const auto submission = submission_of(results, id);
  if (!submission) return submission.error();
  return write_report(*submission, id.task, {machine_name(), 0.0, 0, {reason}});
}

}  // namespace weft::cluster
