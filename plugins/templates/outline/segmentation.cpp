// SPDX-License-Identifier: Apache-2.0
#include "segmentation.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>
#include <weft/core/stop_check.hpp>

namespace weft::outline {
namespace {

constexpr double kLeastContrast = 4.0;  // distance in L*a*b*; the eye sees about 1
constexpr double kSteps = 2.0;          // steps of the 8-bit distances in 1 of L*a*b*
constexpr int kFewestPixels = 100;

cv::Mat3f to_lab(const cv::Mat& photo) {
  cv::Mat bgr = photo, scaled, lab;
  if (photo.channels() == 1) cv::cvtColor(photo, bgr, cv::COLOR_GRAY2BGR);
  cv::GaussianBlur(bgr, bgr, {0, 0}, 1.0);
  bgr.convertTo(scaled, CV_32F, 1.0 / 255.0);
  cv::cvtColor(scaled, lab, cv::COLOR_BGR2Lab);
  return lab;
}

/// The median of each channel over the pixels at most one from the border.
cv::Vec3f border_colour(const cv::Mat3f& lab) {
  std::vector<float> channels[3];
  for (int y = 0; y < lab.rows; ++y) {
    ask_to_go_on();
    for (int x = 0; x < lab.cols; ++x) {
      if (std::min({x, y, lab.cols - 1 - x, lab.rows - 1 - y}) > 1) continue;
      for (int c = 0; c < 3; ++c) channels[c].push_back(lab(y, x)[c]);
    }
  }
  cv::Vec3f median;
  for (int c = 0; c < 3; ++c) {
    auto& values = channels[c];
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    median[c] = *middle;
  }
  return median;
}

cv::Mat1b distances_from(const cv::Mat3f& lab, const cv::Vec3f& colour) {
  cv::Mat1b distances(lab.size());
  for (int y = 0; y < lab.rows; ++y) {
    ask_to_go_on();
    for (int x = 0; x < lab.cols; ++x) {
      distances(y, x) = cv::saturate_cast<std::uint8_t>(kSteps * cv::norm(lab(y, x) - colour));
    }
  }
  return distances;
}

Error nothing_found() {
  return {Errc::invalid_data,
          "no object stands out from the colour along the border of the photograph: photograph it "
          "on a plain background of another colour, lower 'threshold', or give a 'mask'",
          {}};
}

void fill_holes_below(double share, cv::Mat& mask) {
  std::vector<std::vector<cv::Point>> contours;
  std::vector<cv::Vec4i> hierarchy;
  cv::findContours(mask.clone(), contours, hierarchy, cv::RETR_CCOMP, cv::CHAIN_APPROX_NONE);
  double outer_px2 = 0.0;
  for (const auto& contour : contours) outer_px2 = std::max(outer_px2, cv::contourArea(contour));
  for (std::size_t i = 0; i < contours.size(); ++i) {
    const bool is_hole = hierarchy[i][3] >= 0;
    if (is_hole && cv::contourArea(contours[i]) < share * outer_px2) {
      cv::drawContours(mask, contours, static_cast<int>(i), cv::Scalar(1), cv::FILLED);
    }
  }
}

}  // namespace

Result<cv::Mat> foreground_of(const cv::Mat& photo, double threshold) {
  if (std::min(photo.rows, photo.cols) < 5) return nothing_found();
  const cv::Mat3f lab = to_lab(photo);
  const cv::Mat1b distances = distances_from(lab, border_colour(lab));
  cv::Mat mask;
  double level = kSteps * threshold;
  if (threshold <= 0.0) {
    level = cv::threshold(distances, mask, 0.0, 1.0, cv::THRESH_BINARY | cv::THRESH_OTSU);
    level = std::max(level, kSteps * kLeastContrast);
  }
  cv::threshold(distances, mask, level, 1.0, cv::THRESH_BINARY);
  if (cv::countNonZero(mask) < kFewestPixels) return nothing_found();
  return mask;
}

Result<cv::Mat> single_object(const cv::Mat& mask, double smallest_hole) {
  const cv::Mat square = cv::Mat::ones(3, 3, CV_8U);
  cv::Mat clean, parts, statistics, centroids;
  cv::morphologyEx(mask, clean, cv::MORPH_OPEN, square);
  cv::morphologyEx(clean, clean, cv::MORPH_CLOSE, square);
  const int count = cv::connectedComponentsWithStats(clean, parts, statistics, centroids, 4);
  int largest = 0, area = 0;
  for (int part = 1; part < count; ++part) {
    if (statistics.at<int>(part, cv::CC_STAT_AREA) <= area) continue;
    largest = part;
    area = statistics.at<int>(part, cv::CC_STAT_AREA);
  }
  if (area < kFewestPixels) {
    return Error{Errc::invalid_data,
                 "the mask of the object is empty (fewer than " + std::to_string(kFewestPixels) +
                     " connected pixels): it must be light where the object is"};
  }
  cv::Mat object = (parts == largest) / 255;
  fill_holes_below(smallest_hole, object);
  return object;
}

bool touches_border(const cv::Mat& mask) {
  return cv::countNonZero(mask.row(0)) + cv::countNonZero(mask.row(mask.rows - 1)) +
             cv::countNonZero(mask.col(0)) + cv::countNonZero(mask.col(mask.cols - 1)) >
         0;
}

}  // namespace weft::outline
