// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>
#include <string>
#include <vector>
#include <weft/core/result.hpp>

namespace weft::cluster {

/// Assigns cells to tasks. A claim is a symbolic link `claims/KEY` to the id of its task. No file
/// system lets two machines make the same link, and a link never exists without its target. A task
/// that Slurm has requeued keeps its id, and with it its claims.
///
/// Claims save work; results do not depend on them: of a cell that was run twice one line counts.
class Claims {
 public:
  /// Claims of the tasks of a results folder; creates what is missing.
  static Result<Claims> open(const std::string& results);

  /// The task that has the cell now: `task`, or the one that was first.
  Result<std::string> take(const std::string& key, const std::string& task) const;
  void release(const std::string& key, const std::string& task) const;

  /// The folder for what this task writes before it is whole.
  std::string work_of(const std::string& task) const;

  /// Takes claims and begun files from all tasks but these.
  void clear(const std::set<std::string>& tasks) const;

 private:
  explicit Claims(std::string folder) : folder_(std::move(folder)) {}

  std::string folder_;  ///< cluster_folder()
};

}  // namespace weft::cluster
