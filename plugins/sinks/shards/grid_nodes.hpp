// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>
#include <weft/core/result.hpp>
#include <weft/data/ground_truth.hpp>
#include <weft/geometry/face_locator.hpp>
#include <weft/geometry/types.hpp>

namespace weft::shards {

/// The nodes of a regular grid over the template, on the true surface. The faces that carry them
/// are searched again only if the truth's points or faces change.
class GridNodes {
 public:
  /// Nodes [N,2] m as in `template_xy_m`.
  explicit GridNodes(const Points2& nodes_m) : nodes_m_(nodes_m) {}

  struct Places {
    std::vector<float> points_m;        ///< [N,3] m, camera frame; NaN beside the surface
    std::vector<std::uint8_t> visible;  ///< [N] 1 where the camera sees all corners of its face
  };

  /// Fails if the truth has no faces, or if they are no mesh.
  Result<Places> at(const GroundTruth& truth);

 private:
  Result<void> locate(const GroundTruth& truth);

  Points2 nodes_m_;
  Points2 points_xy_m_;
  Faces faces_;
  std::vector<FaceLocation> locations_;
};

}  // namespace weft::shards
