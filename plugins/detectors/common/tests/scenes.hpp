// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <opencv2/imgproc.hpp>
#include <weft/core/rng.hpp>
#include <weft/data/image.hpp>
#include <weft/data/keypoints.hpp>
#include <weft/testing/plugin_under_test.hpp>

namespace weft::detectors {

inline Image image_of(int width, int height, const std::function<double(double, double)>& grey) {
  Image image;
  image.pixels = Array<std::uint8_t>({height, width}, 0);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      image.pixels(y, x) = static_cast<std::uint8_t>(std::clamp(grey(x, y) + 0.5, 0.0, 255.0));
    }
  }
  return image;
}

inline Image constant_image(int width, int height) {
  return image_of(width, height, [](double, double) { return 128.0; });
}

/// Blobs of many sizes, drawn from `seed`.
inline Image texture(int width, int height, std::uint64_t seed) {
  Rng rng(seed);
  cv::Mat grey(height, width, CV_32F, cv::Scalar(128));
  for (const double sigma : {1.0, 2.0, 4.0, 8.0}) {
    cv::Mat noise(height, width, CV_32F);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) noise.at<float>(y, x) = static_cast<float>(rng.normal());
    }
    cv::GaussianBlur(noise, noise, {}, sigma);
    grey += 70.0 * sigma * noise;
  }
  return image_of(width, height, [&](double x, double y) {
    return static_cast<double>(grey.at<float>(static_cast<int>(y), static_cast<int>(x)));
  });
}

inline Keypoints detect(testing::PluginUnderTest& plugin, const Image& image) {
  const testing::PluginAnswer out = plugin.process(0, {testing::input("image", image)});
  EXPECT_TRUE(out.status == WEFT_OK || out.status == WEFT_DEGENERATE) << out.message;
  return out.get<Keypoints>().value();
}

}  // namespace weft::detectors
