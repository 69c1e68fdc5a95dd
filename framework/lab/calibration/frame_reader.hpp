// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>
#include <weft/core/result.hpp>

namespace weft::calibration {

struct Frame {
  std::string name;
  cv::Mat grey;         ///< [H,W] u8, as the sensor stores it
  int orientation = 1;  ///< orientation of EXIF: how the image would be turned to be upright
};

/// Frames in their order.
class FrameReader {
 public:
  virtual ~FrameReader() = default;
  /// Nothing at the end.
  virtual Result<std::optional<Frame>> next() = 0;
};

/// Image files, as the sensor stores them: a camera file describes its grid of pixels, so that
/// views of all orientations belong together.
std::unique_ptr<FrameReader> read_images(std::vector<std::string> paths);

/// A video file; reads about `frames` frames, spread over its length.
Result<std::unique_ptr<FrameReader>> open_film(const std::string& path, int frames);

/// The camera /dev/videoN.
Result<std::unique_ptr<FrameReader>> open_camera(int number);

/// One path that is no image file is a video, all others are images.
Result<std::unique_ptr<FrameReader>> open_files(const std::vector<std::string>& paths);

}  // namespace weft::calibration
