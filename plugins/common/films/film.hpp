// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <opencv2/videoio.hpp>
#include <string>
#include <weft/core/result.hpp>

#include "common/films/packets.hpp"

/// Video files are decoded here, by FFmpeg through OpenCV. What FFmpeg and OpenCV print of damaged
/// files does not reach stderr.
namespace weft::films {

/// The frames of a video file in their order, those included that the decoder refuses. It never
/// seeks.
class Film {
 public:
  enum class Step { frame, refused, end };

  /// Errc::not_found where there is no such file, Errc::invalid_data where it is no video.
  static Result<Film> open(const std::string& path);

  /// Goes to the next frame, at first to frame 0. OpenCV reports a frame that was refused as it
  /// reports the end; frames that come afterwards tell the two apart.
  Step advance();

  /// Of the current frame, counted from 0.
  std::int64_t number() const { return number_; }
  /// Frames by the header; 0 if it does not say. May be an estimate.
  std::int64_t promised() const { return promised_; }
  double fps() const { return fps_; }
  /// Of the current frame [s], as the container says; 0 or below if it does not.
  double stamp_s() const;
  /// As the frames are stored.
  cv::Size size_px() const { return size_px_; }
  /// By which frames are made upright, as EXIF numbers them.
  int orientation() const { return orientation_; }

  /// The current frame as it is stored, BGR, 8 bits a channel; black where the decoder refused it.
  Result<cv::Mat> image();
  /// What is wrong with the current frame; empty for a whole one.
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
  bool is_ahead_ = false;     // whether that frame is grabbed
  bool is_over_ = false;
  bool is_refused_ = false;  // the current frame
};

}  // namespace weft::films
