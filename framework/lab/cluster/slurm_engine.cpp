// SPDX-License-Identifier: Apache-2.0
#include "lab/cluster/slurm_engine.hpp"

#include <algorithm>
#include <filesystem>
#include <set>
#include <weft/core/whole_file.hpp>

#include "lab/cluster/chunks.hpp"
#include "lab/cluster/claims.hpp"
#include "lab/cluster/job_file.hpp"
#include "lab/cluster/queue.hpp"
#include "lab/cluster/slurm.hpp"
#include "lab/cluster/submission.hpp"

namespace weft::cluster {
namespace {

namespace fs = std::filesystem;

/// In a file name of sbatch a percent sign has a meaning.
std::string pattern_of(std::string path) {
  for (std::size_t at = path.find('%'); at != std::string::npos; at = path.find('%', at + 2)) {
    path.insert(at, 1, '%');
  }
  return path;
}

std::string counted(std::size_t count, const std::string& what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

class SlurmEngine final : public lab::Engine {
 public:
  explicit SlurmEngine(SlurmOptions options) : options_(std::move(options)) {}

  Result<std::vector<std::string>> run(const lab::Order& order, const Progress&,
                                       const std::atomic<bool>&) override {
    const std::string clusters = clusters_in(options_.sbatch);
    if (auto usable = check_slurm(options_.partition, clusters); !usable) return usable.error();
    const std::string& results = order.folder.path();
    const auto claims = Claims::open(results);
    if (!claims) return claims.error();
    const auto known = read_submissions(results);
    if (!known) return known.error();
    const auto queued = tasks_of(*known);
    if (!queued) return queued.error();
    std::set<std::string> ids;
    bool are_all_known = true;  // by their own numbers, which claims have
    for (const QueuedTask& task : *queued) {
      ids.insert(task.id);
      are_all_known = are_all_known && task.task != kAllTasks;
    }
    if (are_all_known) claims->clear(ids);
    std::size_t on_their_way = 0;
    const auto groups = groups_without(order.groups, keys_of(*known, *queued), on_their_way);
    std::vector<std::string> said;
    if (on_their_way > 0) {
      said.push_back(std::to_string(on_their_way) + " cells wait or run already");
    }
    const double cell_seconds =
        options_.cell_seconds.value_or(cell_seconds_of(*known).value_or(ChunkSize().cell_seconds));
    const auto chunks =
        cut_into_chunks(groups, {options_.chunk_minutes, cell_seconds, options_.processes});
    if (auto submitted = submit_all(order, chunks, said); !submitted) return submitted.error();
    // SQLite is not safe on folders that machines share, and an older index lacks these cells.
    std::error_code ignored;
    fs::remove(results + "/index.sqlite", ignored);
    for (const Submission& submission : *known) {
      if (!submission.fault.empty()) said.push_back(submission.fault);
    }
    return said;
  }

 private:
  static std::vector<Group> groups_without(const std::vector<std::vector<const lab::Cell*>>& groups,
                                           const std::set<std::string>& queued,
                                           std::size_t& on_their_way) {
    std::vector<Group> rest;
    for (const auto& cells : groups) {
      Group group;
      for (const lab::Cell* cell : cells) {
        if (queued.count(cell->identity.key) == 0) group.push_back(cell->identity.key);
      }
      on_their_way += cells.size() - group.size();
      if (!group.empty()) rest.push_back(std::move(group));
    }
    return rest;
  }

  /// The default of Slurm's MaxArraySize allows this number of tasks.
  Result<void> submit_all(const lab::Order& order, const std::vector<Chunk>& chunks,
                          std::vector<std::string>& said) const {
    constexpr std::size_t kMostTasks = 1000;
    for (std::size_t first = 0; first < chunks.size(); first += kMostTasks) {
      const auto last = std::min(first + kMostTasks, chunks.size());
      const auto begin = chunks.begin();
      const auto submitted = submit_array(order, {begin + static_cast<std::ptrdiff_t>(first),
                                                  begin + static_cast<std::ptrdiff_t>(last)});
      if (!submitted && said.empty()) return submitted.error();
      if (!submitted) {
        return Error{submitted.error().code,
                     submitted.error().message + "; submitted before: " + said.back()};
      }
      said.push_back(*submitted);
    }
    return {};
  }

  Result<std::string> submit_array(const lab::Order& order, std::vector<Chunk> tasks) const {
    const auto submission =
        create_submission(order.folder.path(), std::move(tasks), options_.processes,
                          Equipment::here(order.grid.registry()));
    if (!submission) return submission.error();
    const auto id = submit_found(*submission);
    if (!id) return id.error();
    std::size_t cells = 0;
    for (const Chunk& chunk : submission->tasks) cells += cells_of(chunk);
    const std::string what = "job " + *id + ": " + counted(cells, "cell") + " in " +
                             counted(submission->tasks.size(), "task");
    if (auto collector = submit_collector(*submission, *id); !collector) {
      return what + ", without a summary at their end (" + collector.error().message + ")";
    }
    return what;
  }

  /// The number of the job. A submission stays unless Slurm has refused it for certain: its name
  /// finds a job whose number is not known.
  Result<std::string> submit_found(const Submission& submission) const {
    const std::string clusters = clusters_in(options_.sbatch);
    std::error_code ignored;
    if (auto written = write_job(submission, {"", clusters}); !written) {
      fs::remove_all(submission.folder, ignored);
      return written.error();
    }
    auto job = submit_job(submission);
    bool may_be_queued = !job && job.error().code == Errc::invalid_data;
    if (!job && job.error().code != Errc::not_found) {
      const auto queued = queued_tasks({submission.job}, clusters);
      may_be_queued = may_be_queued || !queued;
      if (queued && !queued->empty()) {
        const QueuedTask& task = queued->front();
        job = Job{task.id.substr(0, task.id.find('_')), task.cluster};
      }
    }
    if (job) return noted(submission, *job, clusters);
    if (may_be_queued) {
      return Error{Errc::io, job.error().message + "; the job may be queued as " + submission.job +
                                 ": run again, which finds it by this name or submits its cells"};
    }
    fs::remove_all(submission.folder, ignored);
    return job.error();
  }

  static Result<std::string> noted(const Submission& submission, const Job& job,
                                   const std::string& clusters) {
    const std::string cluster = job.cluster.empty() ? clusters : job.cluster;
    if (auto written = write_job(submission, {job.id, cluster}); !written) return written.error();
    return job.id;
  }

  Result<Job> submit_job(const Submission& submission) const {
    const std::string script = submission.folder + "/task.sh";
    const std::string task =
        " --task \"" + submission.number + "/${SLURM_ARRAY_JOB_ID}_${SLURM_ARRAY_TASK_ID}\"";
    const std::string command =
        options_.command + " --jobs " + std::to_string(options_.processes) + task;
    if (auto written = write_script(command, script); !written) return written.error();
    std::vector<std::string> arguments = common_arguments();
    arguments.insert(
        arguments.end(),
        {"--job-name=" + submission.job, "--array=0-" + std::to_string(submission.tasks.size() - 1),
         "--cpus-per-task=" + std::to_string(options_.processes), "--requeue",
         "--output=" + pattern_of(submission.folder) + "/task_%a.txt", "--open-mode=append"});
    arguments.push_back(script);
    return submit(arguments);
  }

  /// The job prints the program's report on the folder when all tasks have ended, with any result.
  Result<Job> submit_collector(const Submission& submission, const std::string& id) const {
    const std::string script = submission.folder + "/collect.sh";
    const std::string command = options_.command + " --status";
    if (auto written = write_script(command, script); !written) return written.error();
    std::vector<std::string> arguments = common_arguments();
    arguments.insert(
        arguments.end(),
        {"--job-name=" + submission.job + "-collect", "--dependency=afterany:" + id,
         "--output=" + pattern_of(submission.folder) + "/summary.txt", "--open-mode=truncate"});
    arguments.push_back(script);
    return submit(arguments);
  }

  std::vector<std::string> common_arguments() const {
    std::vector<std::string> arguments = options_.sbatch;
    if (!options_.partition.empty()) arguments.push_back("--partition=" + options_.partition);
    std::error_code ignored;
    arguments.insert(arguments.end(), {"--nodes=1", "--ntasks=1", "--export=ALL",
                                       "--chdir=" + fs::current_path(ignored).string()});
    return arguments;
  }

  static Result<void> write_script(const std::string& command, const std::string& file) {
    return write_whole("#!/bin/sh\nexec " + command + "\n", file);
  }

  SlurmOptions options_;
};

}  // namespace

std::unique_ptr<lab::Engine> slurm_engine(SlurmOptions options) {
  return std::make_unique<SlurmEngine>(std::move(options));
}

}  // namespace weft::cluster
