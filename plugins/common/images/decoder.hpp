// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <weft/images/image_file.hpp>
#include <weft/sdk/call.hpp>

/// All image files of Weft are decoded here: textures, frames, masks, depth, photographs, views of
/// calibration boards. Nothing of it reaches stderr.
namespace weft::image_files {

struct Decoded {
  cv::Mat pixels;      ///< as OpenCV's IMREAD_UNCHANGED has them; empty: cannot be decoded
  std::string damage;  ///< the damage that the decoder of a JPEG found; empty for a whole file
};

enum class Channels { as_stored, grey };

/// The grid of pixels that the file stores, whatever its orientation. Never throws.
Decoded decode_stored(const ImageFile& file, Channels channels = Channels::as_stored);

/// The same, upright by the orientation in the file.
Decoded decode_upright(const ImageFile& file, Channels channels = Channels::as_stored);

/// An image of this EXIF orientation, made upright: all eight are.
cv::Mat upright(const cv::Mat& stored, int orientation);

/// Logs how a file was turned, if it was.
void report_orientation(const Call& call, const std::string& path, int orientation);

/// True if the header alone proves that the file is an image of 8 bits a channel without damage: a
/// PNG, which has checksums.
bool is_surely_whole(const ImageFile& file);

/// An image to which others belong pixel by pixel: masks, depth.
struct Main {
  std::string path;
  cv::Size stored_px;
  int orientation = 1;
};

/// An image that belongs to `main`, upright as that is. Both have the same orientation, or this one
/// has none and its size shows whether it was made of the stored or of the upright image. Fails
/// where that cannot be known.
Result<cv::Mat> upright_beside(const Main& main, const cv::Mat& stored, int orientation,
                               const std::string& path);

/// The pixels of a decoded file without damage; else an error that names the file.
Result<cv::Mat> whole_pixels(const Decoded& decoded, const std::string& path);

}  // namespace weft::image_files
