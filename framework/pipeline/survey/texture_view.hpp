// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <weft/data/image.hpp>
#include <weft/data/template.hpp>

namespace weft {

/// A template's texture as a camera may see it: smaller, aslant, with noise.
struct TextureView {
  Image image;            ///< grey
  Eigen::Matrix2d turn;   ///< px of the image per px of the texture
  Eigen::Vector2d shift;  ///< [2] px

  /// Where a place of the texture is in the image, px.
  Eigen::Vector2d seen_at(const Eigen::Vector2d& texture_px) const {
    return turn * texture_px + shift;
  }
};

/// The object `longest_px` large, or as large as its texture where that is smaller, turned by 15
/// degrees and tilted by 30 about its horizontal axis, before a grey background. A pixel is the
/// mean of what it covers; its noise, sigma 2 grey levels, is drawn from `seed`.
TextureView view_of_texture(const Template& templ, double longest_px, std::uint64_t seed);

}  // namespace weft
