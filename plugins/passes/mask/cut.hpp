// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>

#include "prediction.hpp"
#include "seeds.hpp"

namespace weft::mask {

/// The object in a reduced crop.
struct Cut {
  cv::Mat object;        ///< u8, 255 where the object is
  cv::Mat alike;         ///< u8, 255 for seeds that look like the other class
  double overlap = 0.0;  ///< [] 0 to 1, Bhattacharyya coefficient of both colour models
};

/// Graph cut between two mixtures of five colours, from the seeds. The result depends on the
/// arguments alone.
Cut cut_out(const cv::Mat& bgr, const Seeds& seeds, int iterations);

/// Pixels within `reach` reduced px of those in `marked`: u8, 255 there.
cv::Mat near_marked(const cv::Mat& marked, double reach);

/// Removes bumps and bays that are narrower than 2 `radius` from a cut. Returns where they were,
/// with their surroundings: u8, 255 there.
cv::Mat smooth_out(int radius, cv::Mat& object);

/// Where the outline of a cut is not at an edge of the image, and around that: u8, 255 there.
/// `share` is the share of the outline that is at an edge.
cv::Mat without_edge(const cv::Mat& object, const cv::Mat& grey, double least_edge, double& share);

/// The certainty in the crop of full size: the cut, which the image as a guide moves to its edges
/// (He, Sun, Tang, Guided image filtering, TPAMI 2013).
cv::Mat certainty(const cv::Mat& object, const cv::Mat& grey_of_full_size);

}  // namespace weft::mask
