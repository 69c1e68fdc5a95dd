// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>
#include <weft/core/params.hpp>
#include <weft/core/result.hpp>
#include <weft/data/ground_truth.hpp>

#include "common/truth_archive.hpp"
#include "common/truth_gathering.hpp"

namespace weft::sources {

/// Files of truth that belong to frames by their names: STEM.csv, STEM_KIND.csv, npz or PLY. STEM
/// and KIND may hold underscores; of several stems that a name begins with the longest is its
/// frame's. A frame has one file, or one for each part.
class TruthFiles {
 public:
  /// The parameters truth_parts and truth_unit_m.
  void declare(Params& p);

  /// Finds the files of `pattern` and reads those of true points; an empty pattern finds no file.
  /// Fails on a file without a frame, on two of one part of a frame, and on files of a frame of
  /// several kinds. Also fails on an unknown extension, on a part without files, and where
  /// read_truth_file() does.
  Result<void> open(const std::string& pattern, const std::vector<std::string>& stems);

  /// The truth of the frame of this stem, if it has files. Archives and clouds may hold much, so
  /// that they are read here; the archives of the last frame are kept, for its truth borrows from
  /// them.
  Result<std::optional<GroundTruth>> read(const std::string& stem);

 private:
  enum class Form { points, csv_cloud, ply, npz };
  struct File {
    std::string path;
    std::string kind;        ///< text behind the stem, without the part, or empty
    std::int32_t part = -1;  ///< index in parts_, or -1
    Form form = Form::npz;
    std::optional<GroundTruth> points = {};  ///< points of a CSV file of true points
  };

  Result<File> classify(const std::string& path, const std::string& rest) const;
  Result<void> take(File file, const std::string& stem);
  Result<void> check_parts() const;
  Result<void> add(const File& file, TruthGathering& gathering);

  std::string part_words_;
  double unit_m_ = 1.0;

  std::vector<std::string> parts_;
  std::map<std::string, std::vector<File>> files_of_;  ///< by stem
  std::vector<TruthArchive> archives_;
};

}  // namespace weft::sources
