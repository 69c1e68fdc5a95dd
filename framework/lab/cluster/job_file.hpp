// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lab/cluster/slurm.hpp"
#include "lab/cluster/submission.hpp"

namespace weft::cluster {

/// Writes down where the job of a submission is, or may come to be: without a number before sbatch
/// is called. Its name finds it where the number was lost.
Result<void> write_job(const Submission& submission, const Job& job);

/// Without a file, the job of an earlier version, which did not support other clusters.
Job read_job(const Submission& submission);

/// Clusters that these options of sbatch, or else its environment, choose; empty where they do not.
std::string clusters_in(const std::vector<std::string>& options);

}  // namespace weft::cluster
