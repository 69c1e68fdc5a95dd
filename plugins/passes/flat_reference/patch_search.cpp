// SPDX-License-Identifier: Apache-2.0
#include "patch_search.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>

namespace weft::flat_reference {
namespace {

/// Grey levels below which the correlation is that of rounding.
constexpr double kLeastContrast = 1.0;

/// 255 where a window of `size` that begins there has contrast.
cv::Mat windows_with_contrast(const cv::Mat& grey, cv::Size size) {
  cv::Mat sum, squares;
  cv::integral(grey, sum, squares, CV_64F, CV_64F);
  const cv::Size count(grey.cols - size.width + 1, grey.rows - size.height + 1);
  const auto over_windows = [&](const cv::Mat& integral) {
    const auto from = [&](int x, int y) { return integral(cv::Rect({x, y}, count)); };
    const cv::Mat total =
        from(size.width, size.height) - from(0, size.height) - from(size.width, 0) + from(0, 0);
    return cv::Mat(total / static_cast<double>(size.area()));
  };
  const cv::Mat mean = over_windows(sum);
  return cv::Mat(over_windows(squares) - mean.mul(mean)) >= kLeastContrast * kLeastContrast;
}

}  // namespace

double contrast(const cv::Mat& grey) {
  cv::Scalar mean, deviation;
  cv::meanStdDev(grey, mean, deviation);
  return deviation[0];
}

namespace {

/// The correlations of a patch with windows of an image, and the first window's place.
struct Correlations {
  cv::Mat values, has_contrast;
  cv::Point first_px;
};

Correlations correlate(const cv::Mat& print, const cv::Mat& image, const cv::Rect& patch,
                       cv::Size range_px) {
  const cv::Rect range =
      cv::Rect(patch.tl() - cv::Point(range_px),
               patch.size() + cv::Size(2 * range_px.width, 2 * range_px.height)) &
      cv::Rect({}, image.size());
  const cv::Mat searched = image(range);
  Correlations found{{}, windows_with_contrast(searched, patch.size()), range.tl()};
  cv::matchTemplate(searched, print(patch), found.values, cv::TM_CCOEFF_NORMED);
  return found;
}

}  // namespace

Peak find_patch(const cv::Mat& print, const cv::Mat& unwarped, const cv::Rect& patch,
                cv::Size range_px) {
  const Correlations found = correlate(print, unwarped, patch, range_px);
  Peak peak;
  cv::Point place(-1, -1);
  cv::minMaxLoc(found.values, nullptr, &peak.correlation, nullptr, &place, found.has_contrast);
  if (place.x < 0) return {};
  peak.correlation = std::clamp(peak.correlation, -1.0, 1.0);
  peak.shift_px = place + found.first_px - patch.tl();
  return peak;
}

double likeness_elsewhere(const cv::Mat& print, const cv::Rect& patch, cv::Size range_px,
                          cv::Size near_px) {
  Correlations found = correlate(print, print, patch, range_px);
  const cv::Point place = patch.tl() - found.first_px;
  const cv::Rect own(place - cv::Point(near_px),
                     cv::Size(2 * near_px.width + 1, 2 * near_px.height + 1));
  found.has_contrast(own & cv::Rect({}, found.values.size())) = 0;
  double most = 0.0;
  cv::minMaxLoc(found.values, nullptr, &most, nullptr, nullptr, found.has_contrast);
  return most;
}

}  // namespace weft::flat_reference
