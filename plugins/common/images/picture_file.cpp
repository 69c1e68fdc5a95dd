// SPDX-License-Identifier: Apache-2.0
#include "common/images/picture_file.hpp"

#include <weft/core/stop_check.hpp>

namespace weft::image_files {
namespace {

/// The image on white paper.
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

Error at_parameter(Error error, const std::string& parameter) {
  error.message += ": correct '" + parameter + "' or its file";
  return error;
}

Result<cv::Mat> read_pixels(const std::string& parameter, const std::string& path,
                            Channels channels) {
  const auto file = read_image_bytes(path);
  if (!file) return at_parameter(file.error(), parameter);
  ask_to_go_on();
  auto image = whole_pixels(decode_upright(*file, channels), path);
  return image ? image : at_parameter(image.error(), parameter);
}

Result<cv::Mat> read_picture(const std::string& parameter, const std::string& path) {
  const auto image = read_pixels(parameter, path);
  if (!image) return image.error();
  if (image->depth() != CV_8U) {
    return Error{Errc::invalid_data,
                 path + ": is no image of 8 bits a channel: correct '" + parameter + "'"};
  }
  return image->channels() == 2 || image->channels() == 4 ? opaque(*image) : *image;
}

Result<void> check_picture(const std::string& parameter, const std::string& path) {
  const auto file = read_image_bytes(path);
  if (!file) return at_parameter(file.error(), parameter);
  if (is_surely_whole(*file)) return {};
  const auto picture = read_picture(parameter, path);
  return picture ? Result<void>() : picture.error();
}

}  // namespace weft::image_files
