// SPDX-License-Identifier: Apache-2.0
#include "frame.hpp"

#include <algorithm>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <utility>
#include <weft/core/index.hpp>

namespace weft::live {

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
