// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <weft/core/result.hpp>

namespace weft::outline {

/// The object in a photograph [H,W] grey or [H,W,3] BGR u8. The mask is 1 where the colour is
/// further from that of the background than `threshold` (CIE 1976 distance in L*a*b*), 0 elsewhere.
/// The background's colour is the median of a frame of two pixels along the border. Threshold 0
/// selects Otsu's, which divides the distances best into two classes. Fails where no region differs
/// from the background.
Result<cv::Mat> foreground_of(const cv::Mat& photo, double threshold);

/// The largest connected part of a mask [H,W] of 0 and 1, after an opening and a closing of 3 x 3.
/// Holes below `smallest_hole`, a share of the area in its outline, are filled. Fails where nothing
/// is left.
Result<cv::Mat> single_object(const cv::Mat& mask, double smallest_hole);

/// True if the object reaches the border of its image, and may be cut off there.
bool touches_border(const cv::Mat& mask);

}  // namespace weft::outline
