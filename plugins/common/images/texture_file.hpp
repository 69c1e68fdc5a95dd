// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <weft/core/result.hpp>
#include <weft/data/template.hpp>

#include "common/images/decoder.hpp"

namespace weft::image_files {

struct Texture {
  cv::Mat pixels;          ///< [H,W] grey u8 or [H,W,3] BGR u8
  cv::Mat mask;            ///< [H,W] u8, 1 where the image is not transparent
  bool has_alpha = false;  ///< else the mask is 1 everywhere
  int orientation = 1;     ///< the orientation in the file, by which it was made upright
};

/// Reads an image of 8 bits a channel, made upright. The mask is 1 where an alpha channel is at
/// least one half, and everywhere when there is none. Fails with a message that names the file and
/// the parameter.
Result<Texture> read_texture_file(const std::string& parameter, const std::string& path);

/// Fails where read_texture_file() would fail, but does not decode a PNG without transparency.
Result<void> check_texture_file(const std::string& parameter, const std::string& path);

/// Copies pixels and mask into the template's texture and mask.
void store(const Texture& texture, Template& templ);

}  // namespace weft::image_files
