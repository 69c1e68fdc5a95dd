// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <vector>
#include <weft/core/result.hpp>
#include <weft/data/keypoints.hpp>

namespace weft::detectors {

/// OpenCV's keypoints as a record: degrees become radians, and scales are `scale_per_size` times
/// OpenCV's sizes. `descriptors` [K,D] are f32 for metric l2 or u8 for hamming. No keypoints is a
/// degenerate answer.
Result<Keypoints> answer(const std::vector<cv::KeyPoint>& keypoints, const cv::Mat& descriptors,
                         double scale_per_size);

}  // namespace weft::detectors
