// SPDX-License-Identifier: Apache-2.0
#include "common/texture_file.hpp"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace weft::templates {
namespace {

constexpr double kHalfOpaque = 127.0;

Result<cv::Mat> decode_file(const std::string& parameter, const std::string& path) {
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
  try {
    if (!bytes.empty()) {
      if (cv::Mat image = cv::imdecode(bytes, cv::IMREAD_UNCHANGED); !image.empty()) return image;
    }
  } catch (const cv::Exception&) {  // reported below: the file is at fault
  }
  return Error{Errc::invalid_data,
               path + ": the " + parameter +
                   " is no image that can be decoded (empty, damaged or of an unknown format)",
               {}};
}

}  // namespace

Result<Texture> read_texture_file(const std::string& parameter, const std::string& path) {
  auto image = decode_file(parameter, path);
  if (!image) return image.error();
  if (image->depth() != CV_8U) {
    return Error{
        Errc::unsupported,
        path + ": the " + parameter + " has more than 8 bits a channel: convert it to 8 bits",
        {}};
  }
  Texture texture{*image, cv::Mat::ones(image->size(), CV_8U)};
  if (const int channels = image->channels(); channels == 2 || channels == 4) {
    texture.has_alpha = true;
    cv::extractChannel(*image, texture.mask, channels - 1);
    cv::threshold(texture.mask, texture.mask, kHalfOpaque, 1.0, cv::THRESH_BINARY);
    if (channels == 2) cv::extractChannel(*image, texture.pixels, 0);
    if (channels == 4) cv::cvtColor(*image, texture.pixels, cv::COLOR_BGRA2BGR);
  }
  if (cv::countNonZero(texture.mask) == 0) {
    return Error{
        Errc::invalid_data,
        path + ": the " + parameter + " is transparent everywhere: remove its alpha channel",
        {}};
  }
  return texture;
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

}  // namespace weft::templates
