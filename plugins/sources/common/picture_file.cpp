// SPDX-License-Identifier: Apache-2.0
#include "common/picture_file.hpp"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <opencv2/imgcodecs.hpp>
#include <vector>
#include <weft/core/stop_check.hpp>

namespace weft::sources {
namespace {

cv::Mat decode(const std::vector<char>& bytes) {
  try {
    if (!bytes.empty()) return cv::imdecode(bytes, cv::IMREAD_UNCHANGED);
  } catch (const cv::Exception&) {  // reported by the caller: the file is at fault
  }
  return {};
}

/// The picture on white paper.
cv::Mat opaque(const cv::Mat& image) {
  cv::Mat bgra = image, result(image.size(), CV_8UC3);
  if (image.channels() == 2) {
    const int both[] = {0, 0, 0, 1, 0, 2, 1, 3};
    bgra.create(image.size(), CV_8UC4);
    cv::mixChannels(&image, 1, &bgra, 1, both, 4);
  }
  for (int y = 0; y < image.rows; ++y) {
    ask_to_go_on();
    for (int x = 0; x < image.cols; ++x) {
      const cv::Vec4b& pixel = bgra.at<cv::Vec4b>(y, x);
      for (int c = 0; c < 3; ++c) {
        const int over = pixel[c] * pixel[3] + 255 * (255 - pixel[3]);
        result.at<cv::Vec3b>(y, x)[c] = static_cast<std::uint8_t>((over + 127) / 255);
      }
    }
  }
  return result;
}

}  // namespace

Result<cv::Mat> read_picture(const std::string& parameter, const std::string& path) {
  std::error_code status;
  if (!std::filesystem::is_regular_file(path, status)) {
    return Error{
        Errc::not_found, path + ": there is no such file: correct '" + parameter + "'", {}};
  }
  std::ifstream stream(path, std::ios::binary);
  const std::vector<char> bytes{std::istreambuf_iterator<char>(stream), {}};
  if (!stream) {
    return Error{
        Errc::not_found, path + ": cannot be read: correct '" + parameter + "' or its file", {}};
  }
  const cv::Mat image = decode(bytes);
  if (image.empty() || image.depth() != CV_8U) {
    return Error{Errc::invalid_data,
                 path + ": is no image of 8 bits a channel: correct '" + parameter + "'",
                 {}};
  }
  return image.channels() == 2 || image.channels() == 4 ? opaque(image) : image;
}

}  // namespace weft::sources
