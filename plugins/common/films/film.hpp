// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <opencv2/videoio.hpp>
#include <string>
#include <weft/core/result.hpp>

#include "common/films/packets.hpp"

/// This library decodes video files by FFmpeg through OpenCV. It keeps the messages of FFmpeg and
/// OpenCV on damaged files from stderr.
namespace weft::films {

/// The frames of a video file in their order, those included that the decoder refuses. It never
/// seeks.
class Film {
 public:
  enum class Step { frame, refused, end };

  /// Errc::not_found where there is no such file, Errc::invalid_data where it is no video.
  static Result<Film> open(const std::string& path);

  /// Goes to the next frame, at first to frame 0. OpenCV reports a refused frame as it reports the
  /// end; only later frames distinguish the two.
  Step advance();

  /// Number of the current frame, counted from 0.
  std::int64_t number() const { return number_; }
  /// Number of frames in the header; 0 if the header has none. May be an estimate.
  std::int64_t promised() const { return promised_; }
  double fps() const { return fps_; }
  /// Time of the current frame [s] in the container; 0 or below if it has none.
  double stamp_s() const;
  /// As the frames are stored.
  cv::Size size_px() const { return size_px_; }
  /// The EXIF orientation by which frames are made upright.
  int orientation() const { return orientation_; }

  /// The current frame as it is stored, BGR, 8 bits a channel; black where the decoder refused it.
  Result<cv::Mat> image();
  /// The damage of the current frame; empty for a whole one.
  std::string damage();

 private:
  bool look_ahead();

  std::string path_;
  cv::VideoCapture capture_;
  Packets packets_;
  double fps_ = 0.0;
  std::int64_t promised_ = 0, number_ = -1;
  cv::Size size_px_;
  int orientation_ = 1;
  std::int64_t refused_ = 0;  // frames before the one that is grabbed, or before the end
  bool is_ahead_ = false;     // true if that frame is grabbed
  bool is_over_ = false;
  bool is_refused_ = false;  // the current frame
};

}  // namespace weft::films
