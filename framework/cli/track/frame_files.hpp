// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <weft/core/result.hpp>

namespace weft::cli {

/// The frames of a film or of a folder of images.
struct FrameFiles {
  bool is_video = false;
  std::string path;         ///< path of the film, or a pattern of the images; absolute
  bool is_sequence = true;  ///< frames of a film, else unordered images
  std::string why;          ///< why they are one or the other, in words; empty for a film
  bool tell_focal = false;  ///< EXIF of the first image contains its focal length
};

/// Looks at a film or a folder, in which the file `object` is not one of the frames. Images are a
/// sequence if all have one size and their names differ in a number that mostly rises by the same
/// step. Fails where there is nothing, where a folder has no images, or where it has images with
/// several extensions.
Result<FrameFiles> find_frames(const std::string& path, const std::string& object);

}  // namespace weft::cli
