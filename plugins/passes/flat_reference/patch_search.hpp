// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>

namespace weft::flat_reference {

/// Where a patch is most like the unwarped image.
struct Peak {
  double correlation = 0.0;  ///< [] -1 to 1
  cv::Point shift_px;        ///< from the place of the patch, whole texels
};

/// Standard deviation of the grey levels.
double contrast(const cv::Mat& grey);

/// Searches the patch of the texture by normalised cross-correlation (of grey levels without their
/// means) in `unwarped`, which has the size of the texture. The shifts are at most `range_px` along
/// each axis and leave the patch inside. Places without contrast are omitted: their correlation is
/// undefined, and 0 where there are no others.
Peak find_patch(const cv::Mat& print, const cv::Mat& unwarped, const cv::Rect& patch,
                cv::Size range_px);

/// The highest correlation of a patch with the texture itself further than `near_px` from its
/// place, within the same range; 0 where there is no other place with contrast.
double likeness_elsewhere(const cv::Mat& print, const cv::Rect& patch, cv::Size range_px,
                          cv::Size near_px);

}  // namespace weft::flat_reference
