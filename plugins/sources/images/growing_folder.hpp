// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <unordered_set>
#include <utility>
#include <vector>
#include <weft/core/result.hpp>
#include <weft/sdk/call.hpp>

#include "written_file.hpp"

namespace weft::images {

/// A folder that another program fills: its files one after the other, in the natural order of
/// their names, each when it is complete. A file that sorts before the last returned file comes too
/// late: it is omitted, with a warning.
class GrowingFolder {
 public:
  /// `pattern` has * ? or [ ] in its file name alone. The folder must be there, files need not.
  static Result<GrowingFolder> open(const std::string& pattern, double wait_s);

  /// Waits for the next file and returns its path. Returns Errc::end when none came for `wait_s`.
  /// Fails where none came at all, or only files that came too late, or where the folder is gone.
  /// Checks again and again whether the call is cancelled.
  Result<std::string> next(const Call& call);

 private:
  GrowingFolder(std::string folder, std::string name, double wait_s)
      : folder_(std::move(folder)), name_(std::move(name)), wait_s_(wait_s) {}

  Result<void> list(const Call& call);
  bool has_complete();
  std::string take();
  Error ending() const;
  std::string path_of(const std::string& name) const { return folder_ + "/" + name; }

  std::string folder_;
  std::string name_;  ///< pattern of the files' names
  double wait_s_;

  std::vector<std::string> waiting_;         ///< names of files not given yet, in order
  std::unordered_set<std::string> settled_;  ///< names of files that were given or came too late
  std::string last_;                         ///< name of the last one given
  int late_ = 0;                             ///< files that came too late since that one
  std::optional<WrittenFile> first_;         ///< the first one waiting
};

}  // namespace weft::images
