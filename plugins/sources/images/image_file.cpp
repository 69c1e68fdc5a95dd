// SPDX-License-Identifier: Apache-2.0
#include "image_file.hpp"

#include <fstream>
#include <iterator>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace weft::images {

Result<cv::Mat> read_image_file(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  const std::vector<char> bytes{std::istreambuf_iterator<char>(stream), {}};
  if (!stream) return Error{Errc::io, path + ": cannot be read", {}};
  cv::Mat image;
  try {
    if (!bytes.empty()) image = cv::imdecode(bytes, cv::IMREAD_UNCHANGED);
  } catch (const cv::Exception&) {
    image.release();
  }
  if (image.empty()) {
    return Error{
        Errc::invalid_data,
        path + ": is no image that can be decoded (empty, damaged or of an unknown format)",
        {}};
  }
  if (image.depth() != CV_8U) {
    return Error{Errc::unsupported,
                 path +
                     ": has more than 8 bits a channel; convert the images to 8 bits, since only "
                     "you know which values are black and white",
                 {}};
  }
  if (image.channels() == 2) cv::extractChannel(image, image, 0);
  if (image.channels() == 4) cv::cvtColor(image, image, cv::COLOR_BGRA2BGR);
  return image;
}

}  // namespace weft::images
