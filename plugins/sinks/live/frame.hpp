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
#include <weft/data/correspondences.hpp>
#include <weft/data/ground_truth.hpp>
#include <weft/data/shape.hpp>

namespace weft::live {

/// Bytes that several clients are sent.
using Text = std::shared_ptr<const std::string>;

struct PictureStyle {
  int quality = 80;  ///< [] of JPEG, 1 to 100
  int width_px = 0;  ///< [] px, maximum width of images; 0: unlimited
};

/// JPEG of [H,W] or [H,W,3] grey levels or BGR; empty without an image.
std::string jpeg_of(const Array<std::uint8_t>& pixels, const PictureStyle& style);

/// Matches of a frame, evenly selected where there are many.
struct MatchCopy {
  std::int64_t count = 0;          ///< [] of all matches of the frame
  std::vector<float> px;           ///< [N,2] px of the image
  std::vector<float> uv;           ///< [N,2] from 0 to 1 from the texture's upper left corner
  std::vector<std::uint8_t> kept;  ///< [N] 0 or 1
  std::vector<float> score;        ///< [N] larger is more trusted
};

/// The texture has that size, [] px.
MatchCopy copy_of(const Correspondences& matches, double texture_width_px,
                  double texture_height_px);
/// [V,3] m, camera frame.
std::vector<float> vertices_of(const Shape& shape);
/// [T,3] m, camera frame: points and cloud of the ground truth, evenly selected where there are
/// many.
std::vector<float> points_of(const GroundTruth& truth);

/// A copy of the parts of a frame that are shown.
struct FrameCopy {
  std::uint64_t frame = 0;                                   ///< [] of the source, from 0
  double time_s = std::numeric_limits<double>::quiet_NaN();  ///< [] s since the first frame, or NaN
  std::uint64_t taken_ns = 0;  ///< [] ns since the view opened, when the sink was given the frame
  std::uint64_t written = 0;   ///< [] frames that the sink was given before this one
  Array<std::uint8_t> pixels;  ///< [H,W] or [H,W,3]; absent where there are none
  std::vector<float> vertices_m;      ///< [V,3] m, camera frame; empty without a shape
  std::vector<std::uint8_t> visible;  ///< [V] 0 or 1; empty where unknown
  MatchCopy matches;                  ///< empty where the pipeline has none
  std::vector<float> truth_m;         ///< [T,3] m, camera frame; empty where unknown
  std::vector<float> other_m;         ///< [V,3] m, camera frame: another stage's shape, or empty
  ShapeState state = ShapeState::none;
  std::string report;  ///< one JSON object; empty where there is none
};

/// A frame in the form that clients receive. Its expensive parts are made once, at the first
/// request.
class ShownFrame {
 public:
  ShownFrame(FrameCopy copy, const PictureStyle& style) : copy_(std::move(copy)), style_(style) {}

  /// Without pixels once the JPEG is made.
  const FrameCopy& copy() const { return copy_; }
  const std::string& jpeg();
  /// The result of `make` for the frame, kept under a name for later requests.
  Text once(std::string_view name, const std::function<std::string(ShownFrame&)>& make);

 private:
  FrameCopy copy_;
  PictureStyle style_;
  bool has_jpeg_ = false;
  std::string jpeg_;
  std::map<std::string, Text, std::less<>> made_;
};

}  // namespace weft::live
