// SPDX-License-Identifier: Apache-2.0
#include "common/inference/input_map.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <weft/core/index.hpp>

namespace weft::inference {
namespace {

constexpr int kColours = 3;

std::string percent_of(double share) {
  return std::to_string(static_cast<int>(std::floor(100.0 * share))) + " %";
}

std::string whole(double value) { return std::to_string(std::lround(value)); }

std::string text_of(const Camera& camera) {
  return std::to_string(camera.width_px) + " x " + std::to_string(camera.height_px) + " px, fx " +
         whole(camera.fx) + ", fy " + whole(camera.fy) + ", cx " + whole(camera.cx) + ", cy " +
         whole(camera.cy);
}

}  // namespace

InputMap::Axis InputMap::make_axis(double f_frame, double c_frame, std::int64_t frame_px,
                                   double f_net, double c_net, std::int64_t net_px) {
  Axis axis;
  axis.scale = f_net / f_frame;
  axis.shift = c_net - axis.scale * c_frame;
  // A box of one pixel of the frame interpolates linearly.
  const double half_box_px = 0.5 * std::max(1.0, 1.0 / axis.scale);
  const int last = static_cast<int>(frame_px) - 1;
  for (std::int64_t i = 0; i < net_px; ++i) {
    const double centre = (static_cast<double>(i) - axis.shift) / axis.scale;
    // Edges, counted from the left edge of pixel 0, within the frame with its border repeated.
    const double low = std::clamp(centre - half_box_px + 0.5, 0.0, frame_px - 1e-9);
    const double high = std::clamp(centre + half_box_px + 0.5, 0.0, static_cast<double>(frame_px));
    const int first = std::min(static_cast<int>(low), last);
    const int end = std::clamp(static_cast<int>(std::ceil(high)) - 1, first, last);
    axis.first.push_back(first);
    axis.first_weight.push_back(axis.weights.size());
    for (int x = first; x <= end; ++x) {
      // The repeated border adds its part to the outermost pixels.
      const double from = x == 0 ? centre - half_box_px + 0.5 : std::max<double>(x, low);
      const double to = x == last ? centre + half_box_px + 0.5 : std::min<double>(x + 1.0, high);
      axis.weights.push_back(
          static_cast<float>(std::clamp((to - from) / (2.0 * half_box_px), 0.0, 1.0)));
    }
  }
  axis.first_weight.push_back(axis.weights.size());
  return axis;
}

double InputMap::covered(const Axis& axis, std::int64_t frame_px, std::int64_t net_px) {
  const double low = std::max(-0.5, axis.scale * -0.5 + axis.shift);
  const double high = std::min(static_cast<double>(net_px) - 0.5,
                               axis.scale * (static_cast<double>(frame_px) - 0.5) + axis.shift);
  return std::max(0.0, high - low) / static_cast<double>(net_px);
}

Result<InputMap> InputMap::create(const Camera& frame, const Camera& network) {
  const bool is_legal = frame.fx > 0.0 && frame.fy > 0.0 && frame.width_px > 0 &&
                        frame.height_px > 0 && std::isfinite(frame.cx + frame.cy);
  if (!is_legal) return Error{Errc::invalid_data, "the camera has no size or no focal length"};
  InputMap map;
  map.frame_width_px_ = frame.width_px;
  map.axes_[0] =
      make_axis(frame.fx, frame.cx, frame.width_px, network.fx, network.cx, network.width_px);
  map.axes_[1] =
      make_axis(frame.fy, frame.cy, frame.height_px, network.fy, network.cy, network.height_px);
  map.covered_share_ = covered(map.axes_[0], frame.width_px, network.width_px) *
                       covered(map.axes_[1], frame.height_px, network.height_px);
  if (map.covered_share_ < kLeastShare) {
    return Error{Errc::unsupported,
                 "the frames (" + text_of(frame) + ") show only " + percent_of(map.covered_share_) +
                     " of the field that the network was trained "
                     "for (" +
                     text_of(network) + "); " + percent_of(kLeastShare) +
                     " are needed: use a wider lens, or train a network for this camera"};
  }
  return map;
}

InputMap InputMap::fit(cv::Size frame_px, cv::Size network_px) {
  const double scale = std::min(static_cast<double>(network_px.width) / frame_px.width,
                                static_cast<double>(network_px.height) / frame_px.height);
  // Edges of pixels coincide: pixel 0 has its left edge at -0.5 in both images.
  InputMap map;
  map.frame_width_px_ = frame_px.width;
  map.axes_[0] = make_axis(1.0, -0.5, frame_px.width, scale, -0.5, network_px.width);
  map.axes_[1] = make_axis(1.0, -0.5, frame_px.height, scale, -0.5, network_px.height);
  map.covered_share_ = covered(map.axes_[0], frame_px.width, network_px.width) *
                       covered(map.axes_[1], frame_px.height, network_px.height);
  return map;
}

cv::Mat InputMap::image(const Array<std::uint8_t>& pixels) const {
  const Axis &along_x = axes_[0], &along_y = axes_[1];
  const int width = static_cast<int>(along_x.first.size());
  const int height = static_cast<int>(along_y.first.size());
  const int channels = static_cast<int>(pixels.dim(2));
  const auto row_values = to_index(width) * kColours;
  cv::Mat result(height, width, CV_32FC3, cv::Scalar::all(0.0));
  std::vector<float> row(row_values);
  // Rows of the frame that no box reaches are skipped; the boxes of two rows may share one.
  int averaged = -1;
  const auto average_row = [&](int y) {
    if (y == averaged) return;
    averaged = y;
    const std::uint8_t* from = pixels.row(y);
    for (int x = 0; x < width; ++x) {
      float sums[kColours] = {0.0F, 0.0F, 0.0F};
      const std::size_t begin = along_x.first_weight[to_index(x)];
      const std::size_t end = along_x.first_weight[to_index(x) + 1];
      const std::uint8_t* pixel = from + std::int64_t{along_x.first[to_index(x)]} * channels;
      for (std::size_t k = begin; k < end; ++k, pixel += channels) {
        for (int c = 0; c < kColours; ++c) {
          const int stored = channels == 1 ? 0 : kColours - 1 - c;  // BGR
          sums[c] += along_x.weights[k] * static_cast<float>(pixel[stored]);
        }
      }
      std::copy_n(sums, kColours, row.data() + to_index(x) * kColours);
    }
  };
  for (int i = 0; i < height; ++i) {
    auto* to = result.ptr<float>(i);
    const std::size_t begin = along_y.first_weight[to_index(i)];
    const std::size_t end = along_y.first_weight[to_index(i) + 1];
    for (std::size_t k = begin; k < end; ++k) {
      average_row(along_y.first[to_index(i)] + static_cast<int>(k - begin));
      for (std::size_t n = 0; n < row_values; ++n) to[n] += along_y.weights[k] * row[n];
    }
  }
  return result;
}

}  // namespace weft::inference
