// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>
#include <weft/core/result.hpp>
#include <weft/data/ground_truth.hpp>

#include "common/clouds/cloud_file.hpp"

namespace weft::sources {

/// Merges the ground truth in the files of a frame.
class TruthGathering {
 public:
  /// True points, with all else that a record of them has. Only one that has more than points may
  /// be among several, and none beside it: `path` names it in the error.
  Result<void> add_points(GroundTruth truth, std::int32_t part, const std::string& path);
  void add_cloud(const Cloud& cloud, std::int32_t part);

  /// `parts` are the names to which the indices of parts refer; empty where no part is scored
  /// separately.
  GroundTruth truth(const std::vector<std::string>& parts) &&;

 private:
  std::vector<GroundTruth> points_;
  std::vector<std::int32_t> part_of_points_;
  std::string first_path_;
  std::vector<Eigen::Vector3d> cloud_m_;
  std::vector<std::array<std::int32_t, 3>> cloud_faces_;
  std::vector<std::int32_t> part_of_cloud_;
};

}  // namespace weft::sources
