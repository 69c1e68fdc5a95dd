// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>

namespace weft::overlay {

/// OpenCV draws at positions in 1/16 px when it is given this shift.
inline constexpr int kShift = 4;

inline cv::Point fixed_point(const cv::Point2d& p) {
  constexpr double kScale = 1 << kShift;
  return {cvRound(p.x * kScale), cvRound(p.y * kScale)};
}

}  // namespace weft::overlay
