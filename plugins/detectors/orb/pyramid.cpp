// SPDX-License-Identifier: Apache-2.0
#include "pyramid.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <weft/core/index.hpp>

namespace weft::orb {
namespace {

/// Side of the window of the blur.
constexpr int kBlurSide = 7;

cv::Rect inside(cv::Size size) { return {Level::kBorder, Level::kBorder, size.width, size.height}; }

/// What is around the pixels of a level, and they.
cv::Mat with_border(const cv::Mat& level) {
  cv::Mat whole = level;
  whole.adjustROI(Level::kBorder, Level::kBorder, Level::kBorder, Level::kBorder);
  return whole;
}

}  // namespace

Pyramid::Pyramid(double scale_factor, int most_levels, int border_px)
    : scale_factor_(scale_factor),
      most_levels_(most_levels),
      border_px_(border_px),
      blur_(cv::getGaussianKernel(kBlurSide, kBlurPx, CV_32F)) {}

double Pyramid::scale_of(int l) const {
  // In the precision of cv::ORB, so that levels have the same sizes.
  return static_cast<double>(
      static_cast<float>(std::pow(static_cast<double>(static_cast<float>(scale_factor_)), l)));
}

cv::Size Pyramid::size_of(int l) const {
  const auto scale = static_cast<float>(scale_of(l));
  return {cvRound(static_cast<float>(image_.width) / scale),
          cvRound(static_cast<float>(image_.height) / scale)};
}

void Pyramid::lay_out(cv::Size image) {
  if (image == image_) return;
  image_ = {};
  levels_.clear();
  memory_.clear();
  image_ = image;
  for (int l = 0; l < most_levels_; ++l) {
    const cv::Size size = size_of(l);
    if (std::min(size.width, size.height) <= 2 * border_px_) break;
    Level level;
    level.scale = scale_of(l);
    for (cv::Mat* plane : {&level.sharp, &level.blurred}) {
      // A row more, for what is read beyond the last one.
      memory_.emplace_back(cv::Mat::zeros(size.height + 2 * Level::kBorder + 1,
                                          size.width + 2 * Level::kBorder + Level::kReadable,
                                          CV_8U));
      *plane = memory_.back()(inside(size));
    }
    levels_.push_back(level);
  }
}

void Pyramid::make(int l, const cv::Mat& image) {
  const Level& level = levels_[to_index(l)];
  cv::Mat whole = with_border(level.sharp), pixels = level.sharp;
  if (l > 0) {
    cv::resize(levels_[to_index(l - 1)].sharp, pixels, pixels.size(), 0.0, 0.0,
               cv::INTER_LINEAR_EXACT);
  }
  cv::copyMakeBorder(l > 0 ? pixels : image, whole, Level::kBorder, Level::kBorder, Level::kBorder,
                     Level::kBorder, cv::BORDER_REFLECT_101 | cv::BORDER_ISOLATED);
  // Points of patches at the least distance from the border may lie on it, which is not blurred.
  whole.copyTo(with_border(level.blurred));
}

void Pyramid::blur_rows(int l, int begin, int end) {
  const Level& level = levels_[to_index(l)];
  cv::Mat to = level.blurred.rowRange(begin, end);
  cv::sepFilter2D(level.sharp.rowRange(begin, end), to, CV_8U, blur_, blur_, {-1, -1}, 0.0,
                  cv::BORDER_REFLECT_101);
}

}  // namespace weft::orb
