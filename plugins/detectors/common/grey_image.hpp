// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <weft/sdk/detector.hpp>

namespace weft::detectors {

/// An error if the image has no pixels or the region has another size than the image.
Result<void> check(const DetectorInput& in);

/// The image [H,W] or [H,W,3] BGR as one grey channel; it borrows the pixels where it can, else
/// they are in `buffer`.
cv::Mat grey_image(const Array<std::uint8_t>& pixels, cv::Mat& buffer);

}  // namespace weft::detectors
