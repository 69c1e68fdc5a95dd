// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>
#include <weft/core/result.hpp>

namespace weft::overlay {

/// A video of JPEG pictures in an AVI container (RIFF, one stream `MJPG`). After each picture the
/// file is a legal video of all pictures so far, so that it can be read however the program ends;
/// only the index by which players seek comes last, with close(). Nothing is buffered here.
class AviFile {
 public:
  AviFile() = default;
  AviFile(const AviFile&) = delete;
  AviFile& operator=(const AviFile&) = delete;
  ~AviFile();

  /// Creates the file, or empties it; pictures have `width` x `height` px. Errors name the file.
  Result<void> open(const std::string& path, double fps, int width, int height);
  bool is_open() const { return file_ >= 0; }

  /// Appends the bytes of one JPEG picture. When that fails, the file ends with the one before it.
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
  std::uint64_t end_ = 0;             ///< of what is whole
  std::uint32_t largest_ = 0;         ///< [bytes] picture
  std::uint32_t index_bytes_ = 0;     ///< of the index with its head; 0 until there is one
  std::vector<std::uint32_t> sizes_;  ///< [bytes] of each picture
};

}  // namespace weft::overlay
