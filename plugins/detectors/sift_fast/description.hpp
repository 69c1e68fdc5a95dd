// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>

#include "pyramid.hpp"
#include "refinement.hpp"

namespace weft::sift_fast {

/// Descriptors of keypoints (Lowe 2004, section 6), from gradients at the nodes of a grid that
/// turns and grows with the keypoint. The contribution of a node to each cell is then the same for
/// all keypoints, and only the nodes' gradients are computed. One for each thread.
class Description {
 public:
  Description();
  ~Description();
  Description(Description&&) noexcept;
  Description& operator=(Description&&) noexcept;

  /// 4 x 4 cells of 8 directions, cut off at 0.2, as whole numbers from 0 to 255 of length about
  /// 512; all 0 where there is no gradient.
  void describe(const Plane& layer, const Spot& spot, float* descriptor);

 private:
  struct Grid;
  std::unique_ptr<Grid> grid_;
};

}  // namespace weft::sift_fast
