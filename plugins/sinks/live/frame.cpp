// SPDX-License-Identifier: Apache-2.0
#include "frame.hpp"

#include <algorithm>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <utility>
#include <weft/core/index.hpp>

namespace weft::live {
namespace {

/// More would be large in a message and crowded on a screen.
constexpr std::int64_t kMostPoints = 4000;

/// Calls `take(i)` for all of `count` indices, or for as many evenly spaced ones as are sent.
template <class Take>
void select(std::int64_t count, Take take) {
  const std::int64_t taken = std::min(count, kMostPoints);
  for (std::int64_t i = 0; i < taken; ++i) take(i * count / taken);
}

void add_points(std::vector<float>& points, const Array<double>& from) {
  if (!from.present()) return;
  select(from.rows(), [&](std::int64_t i) {
    for (int axis = 0; axis < 3; ++axis) points.push_back(static_cast<float>(from(i, axis)));
  });
}

}  // namespace

MatchCopy copy_of(const Correspondences& matches, double texture_width_px,
                  double texture_height_px) {
  MatchCopy copy;
  copy.count = matches.count();
  select(copy.count, [&](std::int64_t i) {
    copy.px.push_back(static_cast<float>(matches.image_px(i, 0)));
    copy.px.push_back(static_cast<float>(matches.image_px(i, 1)));
    copy.uv.push_back(static_cast<float>((matches.template_px(i, 0) + 0.5) / texture_width_px));
    copy.uv.push_back(static_cast<float>((matches.template_px(i, 1) + 0.5) / texture_height_px));
    copy.kept.push_back(matches.kept(i));
    copy.score.push_back(static_cast<float>(matches.score(i)));
  });
  return copy;
}

std::vector<float> points_of(const GroundTruth& truth) {
  std::vector<float> points;
  add_points(points, truth.points_m);
  add_points(points, truth.cloud_m);
  return points;
}

std::vector<float> vertices_of(const Shape& shape) {
  std::vector<float> vertices_m;
  vertices_m.reserve(to_index(3 * shape.vertices_m.rows()));
  for (std::int64_t v = 0; v < shape.vertices_m.rows(); ++v) {
    const double* xyz = shape.vertices_m.row(v);
    for (int i = 0; i < 3; ++i) vertices_m.push_back(static_cast<float>(xyz[i]));
  }
  return vertices_m;
}

std::string jpeg_of(const Array<std::uint8_t>& pixels, const PictureStyle& style) {
  if (!pixels.present() || pixels.size() == 0) return {};
  cv::Mat picture(static_cast<int>(pixels.dim(0)), static_cast<int>(pixels.dim(1)),
                  pixels.ndim() == 2 ? CV_8UC1 : CV_8UC3, const_cast<std::uint8_t*>(pixels.data()),
                  to_index(pixels.row_stride()));
  try {
    if (style.width_px > 0 && style.width_px < picture.cols) {
      const std::int64_t height_px = std::int64_t{picture.rows} * style.width_px / picture.cols;
      const cv::Size size(style.width_px, std::max(1, static_cast<int>(height_px)));
      cv::resize(cv::Mat(picture), picture, size, 0, 0, cv::INTER_AREA);
    }
    std::vector<std::uint8_t> jpeg;
    if (!cv::imencode(".jpg", picture, jpeg, {cv::IMWRITE_JPEG_QUALITY, style.quality})) return {};
    return {jpeg.begin(), jpeg.end()};
  } catch (const cv::Exception&) {
    return {};  // such as an image beyond the 65500 px of the format
  }
}

const std::string& ShownFrame::jpeg() {
  if (!has_jpeg_) {
    jpeg_ = jpeg_of(copy_.pixels, style_);
    copy_.pixels = {};
    has_jpeg_ = true;
  }
  return jpeg_;
}

Text ShownFrame::once(std::string_view name, const std::function<std::string(ShownFrame&)>& make) {
  if (const auto made = made_.find(name); made != made_.end()) return made->second;
  auto text = std::make_shared<const std::string>(make(*this));
  return made_.emplace(name, std::move(text)).first->second;
}

}  // namespace weft::live
