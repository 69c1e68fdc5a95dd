// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>
#include <weft/core/result.hpp>

namespace weft::frex_video {

/// A colour picture with the smaller copies that minification needs.
class Texture {
 public:
  Texture() = default;
  /// `picture` grey or BGR, u8.
  explicit Texture(const cv::Mat& picture);

  int width() const { return levels_.front().cols; }
  int height() const { return levels_.front().rows; }

  /// BGR at (u,v) px of the full picture, centres at integers: trilinear, as if each pixel were
  /// `pitch` texels wide.
  cv::Vec3f sample(float u, float v, float pitch) const;

 private:
  cv::Vec3f bilinear(std::size_t level, float u, float v) const;

  std::vector<cv::Mat3f> levels_;
};

/// Decodes an image of 8 bits a channel to BGR; transparency becomes white paper. Fails with a
/// message that names the parameter and the file.
Result<cv::Mat> read_picture(const std::string& parameter, const std::string& path);

}  // namespace weft::frex_video
