// SPDX-License-Identifier: Apache-2.0
#include "texture.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace weft::frex_video {

Texture::Texture(const cv::Mat& picture) {
  cv::Mat colour = picture;
  if (picture.channels() == 1) cv::cvtColor(picture, colour, cv::COLOR_GRAY2BGR);
  cv::Mat3f level;
  colour.convertTo(level, CV_32FC3);
  levels_.push_back(level);
  while (levels_.back().cols > 1 && levels_.back().rows > 1) {
    cv::Mat3f half;
    cv::resize(levels_.back(), half, {levels_.back().cols / 2, levels_.back().rows / 2}, 0.0, 0.0,
               cv::INTER_AREA);
    levels_.push_back(half);
  }
}

cv::Vec3f Texture::sample(float u, float v, float pitch) const {
  const float level =
      std::clamp(std::log2(std::max(pitch, 1.0F)), 0.0F, static_cast<float>(levels_.size() - 1));
  const auto below = static_cast<std::size_t>(level);
  const float part = level - static_cast<float>(below);
  if (part == 0.0F) return bilinear(below, u, v);
  return (1.0F - part) * bilinear(below, u, v) + part * bilinear(below + 1, u, v);
}

cv::Vec3f Texture::bilinear(std::size_t level, float u, float v) const {
  const cv::Mat3f& picture = levels_[level];
  const auto place = [](float x, int full, int size) {
    const float scaled = (x + 0.5F) * static_cast<float>(size) / static_cast<float>(full) - 0.5F;
    return std::clamp(scaled, 0.0F, static_cast<float>(size - 1));
  };
  const float a = place(u, width(), picture.cols), b = place(v, height(), picture.rows);
  const int i = static_cast<int>(a), j = static_cast<int>(b);
  const int right = std::min(i + 1, picture.cols - 1), below = std::min(j + 1, picture.rows - 1);
  const float s = a - static_cast<float>(i), t = b - static_cast<float>(j);
  return (1.0F - t) * ((1.0F - s) * picture(j, i) + s * picture(j, right)) +
         t * ((1.0F - s) * picture(below, i) + s * picture(below, right));
}

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
  cv::Mat colour = image;
  if (image.channels() == 1) cv::cvtColor(image, colour, cv::COLOR_GRAY2BGR);
  if (image.channels() == 2 || image.channels() == 4) colour = opaque(image);
  return colour;
}

}  // namespace weft::frex_video
