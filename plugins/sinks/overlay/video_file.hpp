// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <string>
#include <weft/core/result.hpp>

#include "avi_file.hpp"
#include "media_file.hpp"

namespace weft::overlay {

/// A video: `.avi` as AviFile writes it, `.mkv` or `.mp4` as MediaFile does. Some players do not
/// accept an `.avi` of more than 2 GiB, so a longer video continues in NAME_2.avi, NAME_3.avi and
/// so on. It overwrites no other file.
class VideoFile {
 public:
  static constexpr std::uint64_t kMostBytesOfAvi = 1'900'000'000;

  explicit VideoFile(std::uint64_t most_bytes_of_avi = kMostBytesOfAvi)
      : most_bytes_of_avi_(most_bytes_of_avi) {}

  /// Fails on a path whose extension names another format.
  static Result<void> check_format(const std::string& path);
  /// Makes the folder if need be. Fails on another extension and when the file cannot be written.
  Result<void> open(const std::string& path, double fps, cv::Size size);
  bool is_open() const { return avi_.is_open() || media_.is_open(); }
  /// `picture` is BGR and has the size of the video. Fails when it cannot be written, or when the
  /// next part cannot be opened.
  Result<void> write(const cv::Mat& picture);
  /// Fails when the video on the disk lacks images; it is closed in any case.
  Result<void> close();

 private:
  Result<void> open_part();
  Result<void> close_part();
  Result<void> add(const cv::Mat& picture);
  Result<void> add_encoded(const cv::Mat& picture);

  std::uint64_t most_bytes_of_avi_;
  std::string path_;
  double fps_ = 0.0;
  cv::Size size_;
  int part_ = 1;
  std::string part_path_;
  std::int64_t given_ = 0;  ///< [] images of this part
  Result<void> first_failure_;
  AviFile avi_;
  MediaFile media_;
};

}  // namespace weft::overlay
