// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>
#include <weft/core/result.hpp>
#include <weft/data/array.hpp>
#include <weft/data/camera.hpp>

namespace weft::inference {

/// The map between a frame and the image that a network was trained with, by the focal lengths and
/// principal points of both cameras. Pixel centres are at integers in both images. Along each axis
///     x_net = cx_net + (fx_net / fx_frame) (x_frame - cx_frame).
class InputMap {
 public:
  /// The least share of the network's field of view that must lie in the frame.
  static constexpr double kLeastShare = 0.8;

  /// Fails if less than kLeastShare of the network's image is covered by the frame.
  static Result<InputMap> create(const Camera& frame, const Camera& network);

  /// The largest map of the whole frame into the network's image with one scale for both axes. The
  /// upper left corners coincide; the rest of the network's image is filled. Sizes must be
  /// positive.
  static InputMap fit(cv::Size frame_px, cv::Size network_px);

  std::array<double, 2> to_network(double x_px, double y_px) const {
    return {axes_[0].scale * x_px + axes_[0].shift, axes_[1].scale * y_px + axes_[1].shift};
  }
  std::array<double, 2> to_frame(double x_px, double y_px) const {
    return {(x_px - axes_[0].shift) / axes_[0].scale, (y_px - axes_[1].shift) / axes_[1].scale};
  }
  /// Pixels of the network's image for each pixel of the frame, along x and y.
  std::array<double, 2> scale() const { return {axes_[0].scale, axes_[1].scale}; }
  /// Share of the network's image that the frame covers.
  double covered_share() const { return covered_share_; }

  /// The network's image of a frame [H,W] grey or [H,W,3] BGR: f32 [height,width,3] RGB, 0 to 255.
  /// Each pixel is the mean of the frame over its area, or linearly interpolated where the frame is
  /// the coarser one. Beyond the frame its border is repeated. The frame must have the size of its
  /// camera.
  cv::Mat image(const Array<std::uint8_t>& pixels) const;

 private:
  /// One axis: x_net = scale x_frame + shift. Pixel i of the network's image is the sum of
  /// weights[first_weight[i] ...] times the frame's pixels from first[i] on.
  struct Axis {
    double scale = 1.0, shift = 0.0;
    std::vector<int> first;                 ///< [n] first pixel of the frame
    std::vector<std::size_t> first_weight;  ///< [n + 1]
    std::vector<float> weights;
  };

  static Axis make_axis(double f_frame, double c_frame, std::int64_t frame_px, double f_net,
                        double c_net, std::int64_t net_px);
  static double covered(const Axis& axis, std::int64_t frame_px, std::int64_t net_px);

  std::array<Axis, 2> axes_;
  std::int64_t frame_width_px_ = 0;
  double covered_share_ = 1.0;
};

}  // namespace weft::inference
