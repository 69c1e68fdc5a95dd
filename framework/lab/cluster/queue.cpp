// SPDX-License-Identifier: Apache-2.0
#include "lab/cluster/queue.hpp"

#include <algorithm>
#include <iterator>
#include <map>
#include <weft/core/index.hpp>

#include "lab/cluster/job_file.hpp"

namespace weft::cluster {
namespace {

std::size_t count_of(const Chunk& chunk, const std::set<std::string>& keys) {
  std::size_t count = 0;
  for (const Group& group : chunk) {
    for (const std::string& key : group) count += keys.count(key);
  }
  return count;
}

/// Looks at the tasks of a results folder, one after the other.
class Look {
 public:
  Look(const std::vector<QueuedTask>& queued, const std::set<std::string>& left) : left_(left) {
    for (const QueuedTask& task : queued) queued_.emplace(std::pair(task.job, task.task), &task);
  }

  /// The newest submission comes first, because it explains why a cell has no result.
  void add(const Submission& submission) {
    for (int task = 0; task < static_cast<int>(submission.tasks.size()); ++task) {
      const Chunk& chunk = submission.tasks[to_index(task)];
      const std::size_t open = count_of(chunk, left_);
      auto found = queued_.find({submission.job, task});
      if (found == queued_.end()) found = queued_.find({submission.job, kAllTasks});
      if (found == queued_.end()) {
        ++state_.ended;
        if (open > 0) explain(submission, task, open);
        continue;
      }
      ++(found->second->running ? state_.running : state_.waiting);
      if (found->second->running) state_.processes += submission.processes;
      if (!found->second->hold_reason.empty()) report_hold(*found->second);
      state_.on_their_way += open;
      note(chunk);
    }
  }

  QueueState state() { return std::move(state_); }

 private:
  void note(const Chunk& chunk) {
    for (const Group& group : chunk) explained_.insert(group.begin(), group.end());
  }

  void report_hold(const QueuedTask& task) {
    state_.reasons.push_back("Slurm holds task " + task.id + " back (" + task.hold_reason +
                             "); `scontrol release " + task.id +
                             "` lets it go, or end all with --cancel and run again");
  }

  void explain(const Submission& submission, int task, std::size_t open) {
    const Chunk& chunk = submission.tasks[to_index(task)];
    if (count_of(chunk, explained_) == cells_of(chunk)) return;
    note(chunk);
    const auto report = read_report(submission, task);
    if (report) {
      for (const std::string& reason : report->left) {
        state_.reasons.push_back(report->machine + ": " + reason);
      }
      return;
    }
    state_.reasons.push_back(std::to_string(open) + " cells of a task that ended early; " +
                             submission.log_of(task) +
                             " may have the reason. If there is none, it was never started, or its "
                             "machine does not share the folder");
  }

  const std::set<std::string>& left_;
  std::map<std::pair<std::string, int>, const QueuedTask*> queued_;
  std::set<std::string> explained_;  ///< cells for which newer tasks have a reason
  QueueState state_;
};

}  // namespace

Result<std::vector<QueuedTask>> tasks_of(const std::vector<Submission>& submissions) {
  std::map<std::string, std::vector<std::string>> names;  // by cluster
  for (const Submission& submission : submissions) {
    names[read_job(submission).cluster].push_back(submission.job);
  }
  std::vector<QueuedTask> all;
  for (const auto& [cluster, jobs] : names) {
    auto tasks = queued_tasks(jobs, cluster);
    if (!tasks) return tasks.error();
    std::move(tasks->begin(), tasks->end(), std::back_inserter(all));
  }
  return all;
}

std::set<std::string> keys_of(const std::vector<Submission>& submissions,
                              const std::vector<QueuedTask>& tasks) {
  std::map<std::string, const Submission*> by_job;
  for (const Submission& submission : submissions) by_job.emplace(submission.job, &submission);
  std::set<std::string> keys;
  for (const QueuedTask& task : tasks) {
    const auto submission = by_job.find(task.job);
    if (submission == by_job.end()) continue;
    const auto& chunks = submission->second->tasks;
    for (int number = 0; number < static_cast<int>(chunks.size()); ++number) {
      if (task.task != number && task.task != kAllTasks) continue;
      for (const Group& group : chunks[to_index(number)]) keys.insert(group.begin(), group.end());
    }
  }
  return keys;
}

std::optional<double> cell_seconds_of(const std::vector<Submission>& submissions) {
  double seconds = 0.0;
  std::size_t cells = 0;
  for (const Submission& submission : submissions) {
    for (int task = 0; task < static_cast<int>(submission.tasks.size()); ++task) {
      const auto report = read_report(submission, task);
      if (!report || report->cells == 0) continue;
      seconds += report->seconds * submission.processes;
      cells += report->cells;
    }
  }
  return cells > 0 ? std::optional(seconds / static_cast<double>(cells)) : std::nullopt;
}

Result<QueueState> look_at_queue(const std::string& results, const std::set<std::string>& left) {
  const auto submissions = read_submissions(results);
  if (!submissions) return submissions.error();
  const auto queued = tasks_of(*submissions);
  if (!queued) return queued.error();
  Look look(*queued, left);
  for (auto each = submissions->rbegin(); each != submissions->rend(); ++each) look.add(*each);
  QueueState state = look.state();
  for (const Submission& submission : *submissions) {
    if (!submission.fault.empty()) state.reasons.push_back(submission.fault);
  }
  state.cell_seconds = cell_seconds_of(*submissions);
  return state;
}

Result<std::size_t> cancel_tasks(const std::string& results) {
  const auto submissions = read_submissions(results);
  if (!submissions) return submissions.error();
  const auto queued = tasks_of(*submissions);
  if (!queued) return queued.error();
  std::map<std::string, std::set<std::string>> jobs;  // by cluster
  for (const QueuedTask& task : *queued) {
    jobs[task.cluster].insert(task.id.substr(0, task.id.find('_')));
  }
  for (const auto& [cluster, ids] : jobs) {
    if (auto ended = cancel_jobs({ids.begin(), ids.end()}, cluster); !ended) return ended.error();
  }
  return queued->size();
}

}  // namespace weft::cluster
