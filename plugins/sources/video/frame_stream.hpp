// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <opencv2/videoio.hpp>
#include <optional>
#include <string>
#include <weft/core/result.hpp>

#include "common/cameras/upright_camera.hpp"
#include "common/films/film.hpp"

namespace weft::video {

/// The settings that are requested from a camera.
struct CameraSettings {
  cv::Size size_px;
  std::string format;        ///< four characters such as MJPG; empty for its own
  double fps = 0.0;          ///< [1/s] 0 for its own
  double exposure_ms = 0.0;  ///< [ms] 0 for that which it has, below 0 for an automatic one
};

/// The frames of a video file or of a camera, one after the other. It never seeks: the containers'
/// tables lead to wrong frames too often, decoding in order always gives the same ones. A frame of
/// a file that the decoder refuses counts as one.
class FrameStream {
 public:
  /// Fails, with the reason, on a file that is missing or no video.
  static Result<FrameStream> open_file(const std::string& path);
  /// The camera /dev/videoN. Fails when it is missing, busy or does not take a setting.
  static Result<FrameStream> open_device(int number, const CameraSettings& settings);
  /// A live source: an address such as rtsp://..., a pipe of the file system, or a pipeline of
  /// GStreamer that ends in `appsink`. Waits at most `patience_s` for it.
  static Result<FrameStream> open_address(const std::string& address, double patience_s,
                                          const std::function<bool()>& cancelled);

  /// From now on images are turned clockwise by this number of quarter turns, after the rotation
  /// of the file.
  void turn(int quarter_turns) { quarter_turns_ = quarter_turns; }

  /// Goes to the next frame, at first to frame 0; false when there is none.
  bool advance();
  /// After advance() returned false: an error unless a file ended where its header ends.
  Result<void> ending() const;

  /// Lets go of the file or camera; what is known of its last frame stays.
  void close();
  /// Continues the count of another stream, whose last frame was `gap_s` before the first one of
  /// this stream.
  void continue_from(const FrameStream& before, double gap_s);

  /// Number of the current frame, counted from 0 as they are decoded.
  std::int64_t number() const { return number_; }
  /// Time of the current frame, s since frame 0: the time of the container or the driver, always
  /// increasing.
  double time_s() const { return stamp_s_ - first_stamp_s_; }
  /// The current frame, BGR, 8 bits a channel, upright; black where the decoder refused it.
  Result<cv::Mat> image();
  /// The damage of the current frame of a file; empty for a whole one.
  std::string damage();
  /// How frames are stored, once there is one.
  Result<cameras::StoredImages> stored();
  /// File, device or address, for messages.
  const std::string& name() const { return name_; }

 private:
  double next_stamp_s();
  int orientation() const;

  std::shared_ptr<const void> pipe_;  ///< that `capture_` reads, if any
  cv::VideoCapture capture_;          ///< for live sources
  std::optional<films::Film> film_;   ///< for a file
  std::string name_;
  bool is_live_ = false;
  int quarter_turns_ = 0;
  double fps_ = 0.0;         // for a file
  double promised_s_ = 0.0;  // length of a file according to its header, 0 if it has none
  std::int64_t number_ = -1;
  double first_stamp_s_ = 0.0;
  double stamp_s_ = -1.0;
};

}  // namespace weft::video
