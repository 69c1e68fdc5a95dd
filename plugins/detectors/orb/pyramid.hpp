// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

namespace weft::orb {

/// Descriptors compare points of a level blurred with this sigma [px of the level].
inline constexpr double kBlurPx = 2.0;

/// The image at one size, with mirrored pixels around it.
struct Level {
  /// Pixels around the level; more are readable on the right of each row and after the last one.
  static constexpr int kBorder = 8, kReadable = 64;

  double scale = 1.0;  ///< size of the image over that of the level
  cv::Mat sharp;       ///< [height,width] u8, the level
  cv::Mat blurred;     ///< [height,width] u8, for descriptors

  int width() const { return sharp.cols; }
  int height() const { return sharp.rows; }
  std::ptrdiff_t stride() const { return static_cast<std::ptrdiff_t>(sharp.step[0]); }
};

/// Levels of an image as cv::ORB makes them, to the bit: each resampled from the one before.
/// Memory is kept while the size of the images stays.
class Pyramid {
 public:
  Pyramid(double scale_factor, int most_levels, int border_px);

  /// Makes room for the levels of an image: those that leave pixels between their borders.
  void lay_out(cv::Size image);

  /// Makes level `l`, from the image [H,W] u8 or from the level before; its blurred pixels are left
  /// to blur_rows().
  void make(int l, const cv::Mat& image);

  /// Blurs rows [begin, end) of a level.
  void blur_rows(int l, int begin, int end);

  const std::vector<Level>& levels() const { return levels_; }
  /// Size of a level over that of the image, the inverse.
  double scale_of(int l) const;

 private:
  cv::Size size_of(int l) const;

  double scale_factor_;
  int most_levels_, border_px_;
  cv::Mat blur_;  ///< weights along a row or a column
  cv::Size image_;
  std::vector<Level> levels_;
  std::vector<cv::Mat> memory_;  ///< of sharp and blurred levels, in turns
};

}  // namespace weft::orb
