// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>
#include <weft/core/result.hpp>

namespace weft::overlay {

/// A video of JPEG images in an AVI container (RIFF, one stream `MJPG`). After each image the file
/// is a valid video of all images so far, so that it can be read however the program ends. Only
/// close() writes the index by which players seek. The class buffers nothing.
class AviFile {
 public:
  AviFile() = default;
  AviFile(const AviFile&) = delete;
  AviFile& operator=(const AviFile&) = delete;
  ~AviFile();

  /// Creates the file, or empties it; images have `width` x `height` px. Errors name the file.
  Result<void> open(const std::string& path, double fps, int width, int height);
  bool is_open() const { return file_ >= 0; }

  /// Appends the bytes of one JPEG image. If that fails, the file ends with the previous image.
  Result<void> add(const std::vector<std::uint8_t>& jpeg);

  /// Writes the index and closes the file, whatever comes of it.
  Result<void> close();

  /// [bytes] of the file, without the index.
  std::uint64_t size() const { return end_; }

 private:
  Result<void> append(const std::string& bytes);
  Result<void> write_at(const std::string& bytes, std::uint64_t offset);
  Result<void> write_header();
  Error failure(int reason) const;

  int file_ = -1;
  std::string path_;
  double fps_ = 0.0;
  int width_ = 0, height_ = 0;
  std::uint64_t end_ = 0;             ///< end of the complete part
  std::uint32_t largest_ = 0;         ///< [bytes] largest image
  std::uint32_t index_bytes_ = 0;     ///< size of the index with its head; 0 until there is one
  std::vector<std::uint32_t> sizes_;  ///< [bytes] size of each image
};

}  // namespace weft::overlay
