// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
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

  /// Values of some samples.
  template <int count>
  using Floats = Eigen::Array<float, count, 1>;

  /// One of the copies.
  class Level {
   public:
    Level(const Picture& picture, const std::vector<float>& greys, float scale)
        : picture_(&picture),
          greys_(greys.data()),
          scale_(scale),
          last_column_(static_cast<float>(picture.width - 1)),
          last_row_(static_cast<float>(picture.height - 1)) {}

    /// Bilinear colour at (u,v) px of the full image.
    [[gnu::always_inline]] Colour at(float u, float v) const {
      // Pixel centres are integers: the centre of a block of 2 x 2 is half a pixel from its first.
      const float a = std::clamp((u + 0.5F) * scale_ - 0.5F, 0.0F, last_column_);
      const float b = std::clamp((v + 0.5F) * scale_ - 0.5F, 0.0F, last_row_);
      const int i = static_cast<int>(a), j = static_cast<int>(b);
      const float s = a - static_cast<float>(i), t = b - static_cast<float>(j);
      const Colour* const above = picture_->pixels.data() + to_index(j * picture_->width + i);
      const int right = i + 1 < picture_->width ? 1 : 0;
      const Colour* const below = above + (j + 1 < picture_->height ? picture_->width : 0);
      return (1.0F - t) * ((1.0F - s) * above[0] + s * above[right]) +
             t * ((1.0F - s) * below[0] + s * below[right]);
    }

    /// The same of a grey texture, at several places.
    template <int count>
    Floats<count> greys_at(const Floats<count>& u, const Floats<count>& v) const {
      const Floats<count> a = ((u + 0.5F) * scale_ - 0.5F).max(0.0F).min(last_column_);
      const Floats<count> b = ((v + 0.5F) * scale_ - 0.5F).max(0.0F).min(last_row_);
      const Eigen::Array<int, count, 1> i = a.template cast<int>(), j = b.template cast<int>();
      const Floats<count> s = a - i.template cast<float>(), t = b - j.template cast<float>();
      Floats<count> upper_left, upper_right, lower_left, lower_right;
      const int width = picture_->width + 1;
      for (int k = 0; k < count; ++k) {
        const float* const above = greys_ + j[k] * width + i[k];
        upper_left[k] = above[0];
        upper_right[k] = above[1];
        lower_left[k] = above[width];
        lower_right[k] = above[width + 1];
      }
      return (1.0F - t) * ((1.0F - s) * upper_left + s * upper_right) +
             t * ((1.0F - s) * lower_left + s * lower_right);
    }

   private:
    const Picture* picture_;
    const float* greys_;
    float scale_, last_column_, last_row_;
  };

  /// Trilinear colours for samples that cover about the same number of texels.
  class Sampler {
   public:
    /// At (u,v) px of the full image, pixel centres at integers. Beyond the border it is the colour
    /// of the border.
    [[gnu::always_inline]] Colour at(float u, float v) const {
      const Colour sharp = fine_.at(u, v);
      if (share_ <= 0.0F) return sharp;
      return (1.0F - share_) * sharp + share_ * coarse_.at(u, v);
    }

    /// The same of a grey texture, at several places.
    template <int count>
    Floats<count> greys_at(const Floats<count>& u, const Floats<count>& v) const {
      const Floats<count> sharp = fine_.greys_at(u, v);
      if (share_ <= 0.0F) return sharp;
      return (1.0F - share_) * sharp + share_ * coarse_.greys_at(u, v);
    }

   private:
    friend class MipTexture;
    Sampler(const Level& fine, const Level& coarse, float share)
        : fine_(fine), coarse_(coarse), share_(share) {}

    Level fine_, coarse_;
    float share_;  ///< [] 0 to 1, of the coarse level
  };

  /// For samples that cover about `texels` texels along each side.
  Sampler sampler(float texels) const;
  Colour sample(float u, float v, float texels) const { return sampler(texels).at(u, v); }

 private:
  std::vector<Picture> levels_;
  std::vector<std::vector<float>> greys_;  ///< per level, last column and row twice; or empty
  bool is_grey_;
};

}  // namespace weft::scene
