// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lab/ablation/cell_group.hpp"
#include "lab/ablation/plan/grid.hpp"
#include "lab/results/damage.hpp"

namespace weft::lab {

/// A file of lines that one process writes.
class LineWriter {
 public:
  LineWriter(LineWriter&& other) noexcept;
  LineWriter& operator=(LineWriter&&) = delete;
  ~LineWriter();

  /// Appends a line and makes it last; a line that did not fit is taken back.
  Result<void> append(const std::string& line);

 private:
  friend class ResultsFolder;
  LineWriter(std::string file, int descriptor) : file_(std::move(file)), descriptor_(descriptor) {}

  std::string file_;
  int descriptor_;
  std::int64_t size_ = 0;  ///< [bytes] of whole lines
};

/// A writer of a results folder that others write into at the same time.
struct SharedWriter {
  std::string name;  ///< that no other writer has; of the files of lines
  std::string work;  ///< a folder in the results folder for files that are not whole yet
  std::string log;   ///< the file of what components print
};

/// The folder of an ablation; docs/results.md describes it. Whatever a process has finished stays
/// when it is killed.
class ResultsFolder {
 public:
  /// Creates the folder, or opens one of this schema for this process and its children alone.
  /// Fails where it holds something else or the results of a plan of another name than `plan`,
  /// cannot be written, or is in use.
  static Result<ResultsFolder> open(const std::string& path, const std::string& plan);
  /// The same for reading alone: creates nothing, locks nothing, and may be absent.
  static Result<ResultsFolder> look(const std::string& path, const std::string& plan);
  /// The folder of an ablation under way for one of its writers on several machines: locks nothing.
  static Result<ResultsFolder> join(const std::string& path, const std::string& plan,
                                    SharedWriter writer);
  ResultsFolder(ResultsFolder&& other) noexcept;
  ResultsFolder& operator=(ResultsFolder&&) = delete;
  ~ResultsFolder();

  const std::string& path() const { return path_; }
  /// Files that were missing or damaged when the folder was opened and that describe() writes anew:
  /// a sentence for each.
  const std::vector<std::string>& rebuilt() const { return rebuilt_; }
  /// Where components print.
  std::string log_file() const;

  /// Writes manifest.json and plan.json. `command` repeats the ablation.
  Result<void> describe(const Grid& grid, const std::string& command, bool accept_rebuilt) const;

  /// Takes results back: their lines count no more, for any reader, and their cells have none.
  Result<void> withdraw(const std::vector<Damage>& lines) const;

  /// A new file of lines; those of a timing pass precede the others by name.
  Result<LineWriter> writer(bool timed) const;

  /// Writes what belongs to a cell, then its line.
  Result<void> keep(const Cell& cell, const CellResult& result, bool timed,
                    const Measurement& measurement, LineWriter& lines) const;

 private:
  Result<LineWriter> lines_file(const std::string& kind) const;
  Result<std::string> begin_files(const std::string& folder) const;
  ResultsFolder(std::string path, int lock) : path_(std::move(path)), lock_(lock) {}

  std::string path_;
  int lock_;  ///< descriptor of the folder, which holds the lock; -1 where none is held
  std::optional<SharedWriter> shared_;
  std::vector<std::string> rebuilt_;
};

}  // namespace weft::lab
