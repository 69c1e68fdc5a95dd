// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

namespace weft::matchers {

struct Match {
  int template_keypoint = -1;
  int image_keypoint = -1;
  Eigen::Vector2d template_px;
  Eigen::Vector2d image_px;
  double distance = 0.0;
  double ratio = 0.0;
};

// Both keep the match of smallest distance (the lowest template keypoint among equal ones) and
// leave the rest in its order.

/// Keeps one match for each image point; image keypoints at the same place are one point.
void keep_one_per_image_point(std::vector<Match>& matches);

/// Merges each match into a better one where both of its points lie within `radius_px` of the
/// other's; 0 does nothing.
void merge_duplicates(double radius_px, std::vector<Match>& matches);

}  // namespace weft::matchers
