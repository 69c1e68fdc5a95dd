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
  cv::Mat grey;  ///< [H,W] u8
};

/// Frames in their order.
class FrameReader {
 public:
  virtual ~FrameReader() = default;
  /// Nothing at the end.
  virtual Result<std::optional<Frame>> next() = 0;
};

/// Image files, as their pixels are stored: notes about how they are to be turned are ignored, as
/// sources do.
std::unique_ptr<FrameReader> read_images(std::vector<std::string> paths);

/// A video file, of which about so many frames are read, spread over its length.
Result<std::unique_ptr<FrameReader>> open_film(const std::string& path, int frames);

/// The camera /dev/videoN.
Result<std::unique_ptr<FrameReader>> open_camera(int number);

/// One path that is no image file is a video, all others are images.
Result<std::unique_ptr<FrameReader>> open_files(const std::vector<std::string>& paths);

}  // namespace weft::calibration
