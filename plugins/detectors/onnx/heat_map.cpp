// SPDX-License-Identifier: Apache-2.0
#include "heat_map.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <weft/core/stop_check.hpp>

namespace weft::onnx {
namespace {

/// True if an earlier pixel within the radius, in the order of rows, has the same score.
bool has_equal_before(const cv::Mat& scores, int x, int y, int radius_px) {
  const float score = scores.at<float>(y, x);
  const int left = std::max(0, x - radius_px);
  const int right = std::min(scores.cols - 1, x + radius_px);
  for (int row = y; row >= std::max(0, y - radius_px); --row) {
    const float* values = scores.ptr<float>(row);
    const int end = row == y ? x : right + 1;
    if (std::find(values + left, values + end, score) != values + end) return true;
  }
  return false;
}

bool is_flat(const cv::Mat& scores, int x, int y) {
  for (int row = std::max(0, y - 1); row <= std::min(scores.rows - 1, y + 1); ++row) {
    for (int column = std::max(0, x - 1); column <= std::min(scores.cols - 1, x + 1); ++column) {
      if (scores.at<float>(row, column) != scores.at<float>(y, x)) return false;
    }
  }
  return true;
}

/// The maximum of the parabola through three values at -1, 0 and 1.
double parabola_offset(double before, double here, double after) {
  const double curvature = before - 2.0 * here + after;
  return curvature < 0.0 ? std::clamp(0.5 * (before - after) / curvature, -1.0, 1.0) : 0.0;
}

}  // namespace

cv::Point2d refined_offset(const cv::Mat& scores, int x, int y) {
  const auto at = [&](int dx, int dy) {
    return static_cast<double>(scores.at<float>(y + dy, x + dx));
  };
  const bool has_x = x > 0 && x + 1 < scores.cols, has_y = y > 0 && y + 1 < scores.rows;
  cv::Point2d offset(has_x ? parabola_offset(at(-1, 0), at(0, 0), at(1, 0)) : 0.0,
                     has_y ? parabola_offset(at(0, -1), at(0, 0), at(0, 1)) : 0.0);
  if (!has_x || !has_y) return offset;
  const double gx = 0.5 * (at(1, 0) - at(-1, 0)), gy = 0.5 * (at(0, 1) - at(0, -1));
  const double xx = at(1, 0) - 2.0 * at(0, 0) + at(-1, 0);
  const double yy = at(0, 1) - 2.0 * at(0, 0) + at(0, -1);
  const double xy = 0.25 * (at(1, 1) - at(1, -1) - at(-1, 1) + at(-1, -1));
  const double determinant = xx * yy - xy * xy;
  if (!(xx < 0.0 && determinant > 0.0)) return offset;
  const cv::Point2d joint((xy * gy - yy * gx) / determinant, (xy * gx - xx * gy) / determinant);
  if (std::abs(joint.x) <= 1.0 && std::abs(joint.y) <= 1.0) offset = joint;
  return offset;
}

std::vector<Peak> find_peaks(const cv::Mat& scores, double threshold, int radius_px,
                             int border_px) {
  cv::Mat largest;
  const int side = 2 * radius_px + 1;
  cv::dilate(scores, largest, cv::getStructuringElement(cv::MORPH_RECT, {side, side}));
  std::vector<Peak> peaks;
  for (int y = border_px; y < scores.rows - border_px; ++y) {
    worked(scores.cols);
    const float *values = scores.ptr<float>(y), *maxima = largest.ptr<float>(y);
    for (int x = border_px; x < scores.cols - border_px; ++x) {
      if (values[x] != maxima[x] || !(static_cast<double>(values[x]) >= threshold)) continue;
      if (has_equal_before(scores, x, y, radius_px) || is_flat(scores, x, y)) continue;
      const cv::Point2d offset = refined_offset(scores, x, y);
      peaks.push_back({x + offset.x, y + offset.y, values[x]});
    }
  }
  return peaks;
}

}  // namespace weft::onnx
