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

/// What a camera is asked for.
struct CameraSettings {
  cv::Size size_px;
  double fps = 0.0;          ///< [1/s] 0 for its own
  double exposure_ms = 0.0;  ///< [ms] 0 for its own
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
  /// What a camera sends: an address such as rtsp://..., a pipe of the file system, or a pipeline
  /// of GStreamer that ends in `appsink`. Waits in vain for so many seconds.
  static Result<FrameStream> open_address(const std::string& address, double patience_s,
                                          const std::function<bool()>& cancelled);

  /// Goes to the next frame, at first to frame 0; false when there is none.
  bool advance();
  /// After advance() was false: an error unless a file ended where its header says.
  Result<void> ending() const;

  /// Lets go of the file or camera; what is known of its last frame stays.
  void close();
  /// Counts on from another stream, whose last frame was so many seconds before this one's first.
  void continue_from(const FrameStream& before, double gap_s);

  /// Of the current frame, counted from 0 as they are decoded.
  std::int64_t number() const { return number_; }
  /// Of the current frame, s since frame 0: the container's or the driver's time, and increasing
  /// in any case.
  double time_s() const { return stamp_s_ - first_stamp_s_; }
  /// The current frame, BGR, 8 bits a channel, upright; black where the decoder refused it.
  Result<cv::Mat> image();
  /// What is wrong with the current frame of a file; empty for a whole one.
  std::string damage();
  /// How frames are stored, once there is one.
  Result<cameras::StoredImages> stored();
  /// File, device or address, for messages.
  const std::string& name() const { return name_; }

 private:
  double next_stamp_s();

  std::shared_ptr<const void> pipe_;  ///< that `capture_` reads, if any
  cv::VideoCapture capture_;          ///< of what is live
  std::optional<films::Film> film_;   ///< of a file
  std::string name_;
  bool is_live_ = false;
  double fps_ = 0.0;         // of a file
  double promised_s_ = 0.0;  // length of a file according to its header, 0 if it does not say
  std::int64_t number_ = -1;
  double first_stamp_s_ = 0.0;
  double stamp_s_ = -1.0;
};

}  // namespace weft::video
