// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>
#include <weft/core/result.hpp>
#include <weft/data/ground_truth.hpp>

#include "common/truth_archive.hpp"

namespace weft::sources {

/// Files of truth that belong to frames by their names: STEM.csv, STEM_KIND.csv, or npz. STEM and
/// KIND may hold underscores; of several stems that a name begins with the longest is its frame's.
class TruthFiles {
 public:
  /// Finds the files of `pattern` and reads those that are CSV; no file for an empty pattern. Fails
  /// on a file without a frame, on two of a frame and on what read_truth_file() refuses.
  Result<void> open(const std::string& pattern, const std::vector<std::string>& stems);

  /// The truth of the frame of this stem, if it has a file. Archives may hold much, so that they
  /// are read here; the last is kept, for the truth borrows from it.
  Result<std::optional<GroundTruth>> read(const std::string& stem);

 private:
  struct File {
    std::string path;
    std::string kind;                  ///< what follows the stem, or empty
    std::optional<GroundTruth> truth;  ///< of a CSV file
  };

  std::map<std::string, File> file_of_;  ///< by stem
  std::optional<TruthArchive> archive_;
};

}  // namespace weft::sources
