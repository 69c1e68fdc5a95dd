// SPDX-License-Identifier: Apache-2.0
#include "common/answer.hpp"

#include <algorithm>
#include <numbers>
#include <weft/core/index.hpp>

namespace weft::detectors {
namespace {

template <class T>
Array<T> rows_of(const cv::Mat& descriptors) {
  Array<T> rows({descriptors.rows, descriptors.cols});
  for (int i = 0; i < descriptors.rows; ++i) {
    std::copy_n(descriptors.ptr<T>(i), descriptors.cols, rows.row(i));
  }
  return rows;
}

}  // namespace

Result<Keypoints> answer(const std::vector<cv::KeyPoint>& keypoints, const cv::Mat& descriptors,
                         double scale_per_size) {
  const auto count = static_cast<std::int64_t>(keypoints.size());
  Keypoints result;
  result.xy_px = Array<double>({count, 2});
  result.scale_px = Array<double>({count});
  result.angle_rad = Array<double>({count});
  result.response = Array<double>({count});
  result.octave = Array<std::int32_t>({count});
  for (std::int64_t i = 0; i < count; ++i) {
    const cv::KeyPoint& keypoint = keypoints[to_index(i)];
    result.xy_px(i, 0) = static_cast<double>(keypoint.pt.x);
    result.xy_px(i, 1) = static_cast<double>(keypoint.pt.y);
    result.scale_px(i) = static_cast<double>(keypoint.size) * scale_per_size;
    result.angle_rad(i) = static_cast<double>(keypoint.angle) * std::numbers::pi / 180.0;
    result.response(i) = static_cast<double>(keypoint.response);
    result.octave(i) = keypoint.octave;
  }
  if (descriptors.type() == CV_8U) {
    result.metric = "hamming";
    result.binary_descriptors = rows_of<std::uint8_t>(descriptors);
  } else {
    result.metric = "l2";
    result.descriptors = rows_of<float>(descriptors);
  }
  if (count == 0) return degenerate(std::move(result), "no keypoints");
  return result;
}

}  // namespace weft::detectors
