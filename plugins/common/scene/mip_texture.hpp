// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <vector>
#include <weft/core/index.hpp>

namespace weft::scene {

/// Blue, green and red grey levels; the fourth number is unused.
using Colour = Eigen::Array4f;

/// Colours row by row.
struct Picture {
  int width = 0;                 ///< [] px
  int height = 0;                ///< [] px
  std::vector<Colour> pixels{};  ///< [height * width]

  const Colour& at(int x, int y) const {
    return pixels[to_index(y) * to_index(width) + to_index(x)];
  }
};

/// An image with the halved copies that minification needs (Williams 1983).
class MipTexture {
 public:
  /// Grey or BGR, u8.
  explicit MipTexture(const cv::Mat& picture);
  /// Both sides of the image are at least 1.
  explicit MipTexture(Picture picture, bool is_grey = false);

  int width() const { return levels_.front().width; }
  int height() const { return levels_.front().height; }
  /// True if all its colours are grey.
  bool is_grey() const { return is_grey_; }

  /// Trilinear colour at (u,v) px of the full image, pixel centres at integers, where one sample
  /// covers about `texels` texels along each side. Beyond the border it is the colour of the
  /// border.
  Colour sample(float u, float v, float texels) const;

 private:
  Colour bilinear(const Picture& level, float scale, float u, float v) const;

  std::vector<Picture> levels_;
  bool is_grey_;
};

}  // namespace weft::scene
