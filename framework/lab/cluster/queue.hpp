// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "lab/cluster/slurm.hpp"
#include "lab/cluster/submission.hpp"

/// State of cells that were handed to Slurm.
namespace weft::cluster {

/// The tasks of submissions that Slurm has not done with, on whatever cluster they are.
Result<std::vector<QueuedTask>> tasks_of(const std::vector<Submission>& submissions);

/// Keys of the cells of these tasks.
std::set<std::string> keys_of(const std::vector<Submission>& submissions,
                              const std::vector<QueuedTask>& tasks);

/// [s] that a cell takes one process, of tasks that have ended; nothing while there are none.
std::optional<double> cell_seconds_of(const std::vector<Submission>& submissions);

struct QueueState {
  std::size_t waiting = 0, running = 0, ended = 0;  ///< tasks
  int processes = 0;                                ///< processes of tasks that run
  std::size_t on_their_way = 0;        ///< cells of tasks that wait or run, without a result
  std::optional<double> cell_seconds;  ///< see cell_seconds_of
  std::vector<std::string> reasons =
      {};  ///< why cells have none, from tasks that ended or are held
};

/// State of all submissions of a results folder. `left` are the keys of cells without a result.
Result<QueueState> look_at_queue(const std::string& results, const std::set<std::string>& left);

/// Takes all tasks of a results folder out of the queue and ends those that run. Results of
/// finished cells stay. Returns how many there were.
Result<std::size_t> cancel_tasks(const std::string& results);

}  // namespace weft::cluster
