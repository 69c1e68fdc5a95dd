// SPDX-License-Identifier: Apache-2.0
#include "common/images/texture_file.hpp"

#include <opencv2/imgproc.hpp>
#include <weft/images/image_file.hpp>

#include "common/images/picture_file.hpp"

namespace weft::image_files {
namespace {

constexpr double kHalfOpaque = 127.0;

}  // namespace

Result<Texture> read_texture_file(const std::string& parameter, const std::string& path) {
  const auto file = read_image_bytes(path);
  if (!file) return at_parameter(file.error(), parameter);
  const auto image = whole_pixels(decode_upright(*file), path);
  if (!image) return at_parameter(image.error(), parameter);
  if (image->depth() != CV_8U) {
    return Error{Errc::unsupported, path + ": the " + parameter +
                                        " has more than 8 bits a channel: convert it to 8 bits"};
  }
  Texture texture{*image, cv::Mat::ones(image->size(), CV_8U), false, file->header.orientation};
  if (const int channels = image->channels(); channels == 2 || channels == 4) {
    texture.has_alpha = true;
    cv::extractChannel(*image, texture.mask, channels - 1);
    cv::threshold(texture.mask, texture.mask, kHalfOpaque, 1.0, cv::THRESH_BINARY);
    if (channels == 2) cv::extractChannel(*image, texture.pixels, 0);
    if (channels == 4) cv::cvtColor(*image, texture.pixels, cv::COLOR_BGRA2BGR);
  }
  if (cv::countNonZero(texture.mask) == 0) {
    return Error{Errc::invalid_data, path + ": the " + parameter +
                                         " is transparent everywhere: remove its alpha channel"};
  }
  return texture;
}

Result<void> check_texture_file(const std::string& parameter, const std::string& path) {
  const auto file = read_image_bytes(path);
  if (!file) return at_parameter(file.error(), parameter);
  if (is_surely_whole(*file) && !file->header.has_alpha) return {};
  const auto texture = read_texture_file(parameter, path);
  return texture ? Result<void>() : texture.error();
}

void store(const Texture& texture, Template& templ) {
  const std::int64_t height = texture.pixels.rows, width = texture.pixels.cols;
  templ.texture = texture.pixels.channels() == 1 ? Array<std::uint8_t>({height, width})
                                                 : Array<std::uint8_t>({height, width, 3});
  templ.mask = Array<std::uint8_t>({height, width});
  texture.pixels.copyTo(
      cv::Mat(texture.pixels.size(), texture.pixels.type(), templ.texture.data()));
  texture.mask.copyTo(cv::Mat(texture.mask.size(), CV_8U, templ.mask.data()));
}

}  // namespace weft::image_files
