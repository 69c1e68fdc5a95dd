// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/data/template.hpp>

#include "common/scene/mip_texture.hpp"

namespace weft::frex {

/// The texture of a template.
inline scene::MipTexture print_of(const Template& templ) {
  const auto& texture = templ.texture;
  return scene::MipTexture(
      cv::Mat(static_cast<int>(texture.dim(0)), static_cast<int>(texture.dim(1)),
              texture.ndim() == 3 ? CV_8UC3 : CV_8UC1, const_cast<std::uint8_t*>(texture.data())));
}

}  // namespace weft::frex
