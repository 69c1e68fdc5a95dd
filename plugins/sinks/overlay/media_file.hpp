// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>
#include <weft/core/result.hpp>

namespace weft::overlay {

/// A video that FFmpeg's libraries write: JPEG images in `.mkv`, or H.264 in `.mp4`, as fragments.
/// It can be read after each image, however the program ends. After an error it takes no more
/// images.
class MediaFile {
 public:
  MediaFile();
  MediaFile(const MediaFile&) = delete;
  MediaFile& operator=(const MediaFile&) = delete;
  ~MediaFile();

  /// Creates the file, or empties it; the extension of `path` determines the format. Errors name
  /// the file.
  Result<void> open(const std::string& path, double fps, cv::Size size);
  bool is_open() const { return state_ != nullptr; }
  /// True if the file consists of JPEG images.
  bool takes_jpeg() const;

  /// Appends the bytes of one JPEG image of this size.
  Result<void> add(const std::vector<std::uint8_t>& jpeg);
  /// Encodes and appends a BGR image of this size.
  Result<void> add(const cv::Mat& picture);

  /// Completes and closes the file, whatever comes of it.
  Result<void> close();

  /// How many images a video file has.
  static std::int64_t count_images(const std::string& path);

 private:
  struct State;

  Error failure(int code) const;
  Result<void> start(const std::string& path, double fps, cv::Size size);
  Result<void> write_packet();

  std::string path_;
  Result<void> failed_;
  std::unique_ptr<State> state_;
};

}  // namespace weft::overlay
