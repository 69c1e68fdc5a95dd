// SPDX-License-Identifier: Apache-2.0
#include "small_frame.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>
#include <weft/core/index.hpp>

namespace weft::shards {
namespace {

constexpr std::uint16_t kNone = 65535;

std::uint16_t rounded(double value, double most) {
  return static_cast<std::uint16_t>(std::lround(std::clamp(value, 0.0, most)));
}

/// Share of the square of `side` pixels whose pixels see the texture.
std::uint8_t share_of(const Array<float>& uv_m, std::int64_t top, std::int64_t left,
                      std::int64_t side) {
  std::int64_t seen = 0;
  for (std::int64_t y = top; y < top + side; ++y) {
    const float* row = uv_m.row(y);
    for (std::int64_t x = left; x < left + side; ++x) seen += std::isfinite(row[2 * x]) ? 1 : 0;
  }
  return rounded(255.0 * static_cast<double>(seen) / static_cast<double>(side * side), 255.0);
}

}  // namespace

Result<int> SampleFormat::reduction(const Camera& camera) const {
  if (width_px % cell_px != 0 || height_px % cell_px != 0) {
    return Error{Errc::invalid_value, "'width_px' and 'height_px' are no multiples of 'cell_px' " +
                                          std::to_string(cell_px) + ": change one of them"};
  }
  const std::int64_t times = camera.width_px / width_px;
  if (times >= 1 && camera.width_px == times * width_px && camera.height_px == times * height_px) {
    return static_cast<int>(times);
  }
  return Error{Errc::invalid_value,
               "images of " + std::to_string(camera.width_px) + " x " +
                   std::to_string(camera.height_px) + " px are no multiple of " +
                   std::to_string(width_px) + " x " + std::to_string(height_px) +
                   " px: change 'width_px' and 'height_px', or the size of the source's images"};
}

Camera SampleFormat::reduced(const Camera& camera) const {
  const double times = static_cast<double>(camera.width_px) / width_px;
  Camera small = camera;
  small.fx /= times;
  small.fy /= times;
  small.cx = (camera.cx + 0.5) / times - 0.5;
  small.cy = (camera.cy + 0.5) / times - 0.5;
  small.width_px = width_px;
  small.height_px = height_px;
  return small;
}

std::vector<std::uint8_t> small_image(const SampleFormat& format, const Image& image) {
  const auto& pixels = image.pixels;
  const bool is_grey = pixels.ndim() == 2;
  const cv::Mat full(static_cast<int>(pixels.dim(0)), static_cast<int>(pixels.dim(1)),
                     is_grey ? CV_8UC1 : CV_8UC3, const_cast<std::uint8_t*>(pixels.data()),
                     to_index(pixels.row_stride()));
  cv::Mat reduced;
  cv::resize(full, reduced, {format.width_px, format.height_px}, 0.0, 0.0, cv::INTER_AREA);
  std::vector<std::uint8_t> bytes(to_index(3) * to_index(reduced.rows) * to_index(reduced.cols));
  cv::Mat colours(reduced.rows, reduced.cols, CV_8UC3, bytes.data());
  cv::cvtColor(reduced, colours, is_grey ? cv::COLOR_GRAY2RGB : cv::COLOR_BGR2RGB);
  return bytes;
}

CellLabels cell_labels(const SampleFormat& format, const GroundTruth& truth,
                       const Eigen::Vector2d& pitch_m, const Eigen::Vector2d& texels) {
  const auto side = truth.depth_m.dim(1) / format.columns();  // side of a cell, in pixels
  CellLabels labels;
  for (std::int64_t i = 0; i < format.rows(); ++i) {
    for (std::int64_t j = 0; j < format.columns(); ++j) {
      labels.mask.push_back(share_of(truth.uv_m, i * side, j * side, side));
      // The centre of a cell lies between pixels: a cell has an even number of them.
      const std::int64_t y = i * side + side / 2, x = j * side + side / 2;
      Eigen::Vector2d sum_m = Eigen::Vector2d::Zero();
      double depth_m = 0.0;
      for (std::int64_t row = y - 1; row <= y; ++row) {
        for (std::int64_t column = x - 1; column <= x; ++column) {
          const float* uv_m = truth.uv_m.row(row) + 2 * column;
          sum_m += Eigen::Vector2d(uv_m[0], uv_m[1]);
          depth_m += truth.depth_m(row, column);
        }
      }
      const bool is_seen = sum_m.allFinite();
      const Eigen::Vector2d place = (0.25 * sum_m.array() / pitch_m.array() + 0.5) / texels.array();
      for (int k = 0; k < 2; ++k) {
        labels.uv.push_back(is_seen ? rounded(65534.0 * place[k], 65534.0) : kNone);
      }
      labels.depth.push_back(is_seen ? rounded(1e4 * 0.25 * depth_m, 65535.0) : std::uint16_t{0});
    }
  }
  return labels;
}

}  // namespace weft::shards
