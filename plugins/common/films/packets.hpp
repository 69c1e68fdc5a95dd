// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <opencv2/videoio.hpp>
#include <string>

namespace weft::films {

/// From now on FFmpeg and OpenCV print nothing in this process. Called before anything is opened.
void quiet_decoders();

/// The compressed frames of a video file. In a Motion JPEG each is a JPEG image, whose damage can
/// be found: FFmpeg patches most of it, and at best warns on stderr.
class Packets {
 public:
  /// The packets of a Motion JPEG; empty for other codecs.
  static Packets of_motion_jpeg(const std::string& path, double fourcc);

  bool are_known() const { return capture_.isOpened(); }
  /// The damage of frame `number`; empty for a whole frame, and where damage cannot be detected.
  /// Call it at most once for each frame, in order.
  std::string damage(std::int64_t number);

 private:
  cv::VideoCapture capture_;
  std::int64_t number_ = -1;
};

/// How many compressed frames a video file has.
std::int64_t count_packets(const std::string& path);

}  // namespace weft::films
