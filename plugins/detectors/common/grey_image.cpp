// SPDX-License-Identifier: Apache-2.0
#include "common/grey_image.hpp"

#include <opencv2/imgproc.hpp>
#include <string>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>

namespace weft::detectors {
namespace {

std::string size_text(const Array<std::uint8_t>& image) {
  return std::to_string(image.dim(1)) + " x " + std::to_string(image.dim(0));
}

}  // namespace

Result<void> check(const DetectorInput& in) {
  const Array<std::uint8_t>& pixels = in.image.pixels;
  if (pixels.size() == 0) {
    return Error{Errc::invalid_data, "the image is empty; give at least one pixel"};
  }
  if (in.region &&
      (in.region->mask.dim(0) != pixels.dim(0) || in.region->mask.dim(1) != pixels.dim(1))) {
    return Error{Errc::invalid_data, "the region is " + size_text(in.region->mask) +
                                         " and the image " + size_text(pixels) +
                                         "; give a mask of the image's size"};
  }
  return {};
}

cv::Mat grey_image(const Array<std::uint8_t>& pixels, cv::Mat& buffer) {
  const auto height = static_cast<int>(pixels.dim(0));
  const auto width = static_cast<int>(pixels.dim(1));
  const int type = pixels.ndim() == 3 ? CV_8UC3 : CV_8UC1;
  cv::Mat view;
  if (pixels.row_stride() >= pixels.row_elements()) {
    view = cv::Mat(height, width, type, const_cast<std::uint8_t*>(pixels.data()),
                   to_index(pixels.row_stride()));
  } else {
    view.create(height, width, type);
    for (int y = 0; y < height; ++y) {
      ask_to_go_on();
      std::copy_n(pixels.row(y), pixels.row_elements(), view.ptr(y));
    }
  }
  if (type == CV_8UC1) return view;
  cv::cvtColor(view, buffer, cv::COLOR_BGR2GRAY);
  return buffer;
}

}  // namespace weft::detectors
