// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>

namespace weft::images {

/// An image file into which another program may still be writing. It is complete when
///
/// - its content proves it: the end of a PNG, with correct checksums, or of a JPEG is there; or
/// - it begins as a BMP, TIFF, WebP or PNM, and its writer has gone on to a later file; or
/// - its size and time have stood still for a while: then no more will come, damaged or not.
class WrittenFile {
 public:
  explicit WrittenFile(std::string path) : path_(std::move(path)) {}

  const std::string& path() const { return path_; }

  /// Checks the file once more; call it repeatedly, every few ms. It counts as complete when
  /// nothing has changed for `still_s` and in many checks, because a machine that slept checked
  /// nothing.
  bool is_complete(bool has_later, double still_s);

 private:
  struct State {
    std::uintmax_t bytes;
    std::int64_t changed;  ///< in ticks of the file system's clock

    bool operator==(const State&) const = default;
  };
  enum class End { missing, there, unmarked };  ///< unmarked: the format has no mark of its end

  State look() const;
  End find_end() const;

  std::string path_;
  std::optional<State> state_;
  std::chrono::steady_clock::time_point since_;  ///< when `state_` was first seen
  int looks_ = 0;                                ///< that saw `state_`
  End end_ = End::missing;                       ///< end of the file in `state_`
};

}  // namespace weft::images
