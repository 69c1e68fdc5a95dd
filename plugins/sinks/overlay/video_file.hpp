// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <opencv2/videoio.hpp>
#include <string>
#include <weft/core/result.hpp>

namespace weft::overlay {

/// A video of JPEG pictures: `.avi` by OpenCV's own writer, `.mkv` by FFmpeg. Both can be read up
/// to the last buffer that reached the disk when the program is killed. OpenCV cannot close an
/// `.avi` of more than 2 GiB, so a longer video goes on in NAME_2.avi, NAME_3.avi and so on.
class VideoFile {
 public:
  static constexpr std::uintmax_t kMostBytesOfAvi = 1'900'000'000;

  explicit VideoFile(std::uintmax_t most_bytes_of_avi = kMostBytesOfAvi)
      : most_bytes_of_avi_(most_bytes_of_avi) {}

  /// Makes the folder if need be. Fails on another extension and when the file cannot be written.
  Result<void> open(const std::string& path, double fps, cv::Size size);
  bool is_open() const { return writer_.isOpened(); }
  /// `picture` is BGR and has the size of the video. Fails when the next part cannot be opened.
  Result<void> write(const cv::Mat& picture);
  void close() { writer_.release(); }

 private:
  Result<void> open_part();
  bool part_is_full() const;

  std::uintmax_t most_bytes_of_avi_;
  std::string path_;
  double fps_ = 0.0;
  cv::Size size_;
  int part_ = 1;
  std::string part_path_;
  cv::VideoWriter writer_;
};

}  // namespace weft::overlay
