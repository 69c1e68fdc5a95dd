// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>
#include <weft/data/shape.hpp>

namespace weft::live {

/// Bytes that several clients are sent.
using Text = std::shared_ptr<const std::string>;

struct PictureStyle {
  int quality = 80;  ///< [] of JPEG, 1 to 100
  int width_px = 0;  ///< [] px, of wider pictures; 0: as they are
};

/// JPEG of [H,W] or [H,W,3] grey levels or BGR; empty where there is no picture.
std::string jpeg_of(const Array<std::uint8_t>& pixels, const PictureStyle& style);

/// What is shown of a frame, in memory of its own.
struct FrameCopy {
  std::uint64_t frame = 0;                                   ///< [] of the source, from 0
  double time_s = std::numeric_limits<double>::quiet_NaN();  ///< [] s since the first frame, or NaN
  std::uint64_t taken_ns = 0;  ///< [] ns since the view opened, when the sink was given the frame
  Array<std::uint8_t> pixels;  ///< [H,W] or [H,W,3]; absent where there are none
  std::vector<float> vertices_m;      ///< [V,3] m, camera frame; empty without a shape
  std::vector<std::uint8_t> visible;  ///< [V] 0 or 1; empty where nothing is said
  ShapeState state = ShapeState::none;
  std::string report;  ///< one JSON object; empty where there is none
};

/// A frame as clients get it. What is expensive is made when the first one wants it, and once.
class ShownFrame {
 public:
  ShownFrame(FrameCopy copy, const PictureStyle& style) : copy_(std::move(copy)), style_(style) {}

  /// Without pixels once the picture is made.
  const FrameCopy& copy() const { return copy_; }
  const std::string& jpeg();
  /// What `make` makes of the frame, kept under a name for all who want it later.
  Text once(std::string_view name, const std::function<std::string(ShownFrame&)>& make);

 private:
  FrameCopy copy_;
  PictureStyle style_;
  bool has_jpeg_ = false;
  std::string jpeg_;
  std::map<std::string, Text, std::less<>> made_;
};

}  // namespace weft::live
