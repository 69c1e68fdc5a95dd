// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <opencv2/features2d.hpp>
#include <tuple>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/rng.hpp>

#include "common/tests/scenes.hpp"
#include "corners.hpp"
#include "pattern.hpp"
#include "search.hpp"

namespace weft::orb {
namespace {

using detectors::image_of;
using detectors::texture;

cv::Mat grey_of(const Image& image) {
  return {static_cast<int>(image.pixels.dim(0)), static_cast<int>(image.pixels.dim(1)), CV_8U,
          const_cast<std::uint8_t*>(image.pixels.data())};
}

/// Whole numbers, each grey level as likely as any other.
Image noise(int width, int height, std::uint64_t seed) {
  std::printf("seed %llu\n", static_cast<unsigned long long>(seed));
  Rng rng(seed);
  return image_of(width, height, [&](double, double) { return std::floor(256.0 * rng.uniform()); });
}

TEST(OrbCorners, AreThoseOfOpenCvsFast) {
  const Image images[] = {noise(150, 61, 31), texture(217, 90, 32),
                          image_of(130, 70, [](double x, double y) {  // of the largest contrast
                            return static_cast<int>(x / 9) % 2 == static_cast<int>(y / 7) % 2 ? 255
                                                                                              : 0;
                          })};
  CornerScratch scratch;
  for (const Image& image : images) {
    const cv::Mat grey = grey_of(image);
    cv::Mat wide = cv::Mat::zeros(grey.rows + 1, grey.cols + 80, CV_8U);
    grey.copyTo(wide(cv::Rect(0, 0, grey.cols, grey.rows)));
    for (const int threshold : {1, 10, 60, 254}) {
      std::vector<cv::KeyPoint> expected;
      cv::FAST(grey, expected, threshold, true);
      const Part part{16, grey.cols - 11, 13, grey.rows - 9};
      std::erase_if(expected, [&](const cv::KeyPoint& at) {
        return at.pt.x < 16.0F || at.pt.x >= static_cast<float>(part.right) || at.pt.y < 13.0F ||
               at.pt.y >= static_cast<float>(part.bottom);
      });
      std::vector<Corner> corners;
      find_corners(wide.ptr(), static_cast<std::ptrdiff_t>(wide.step[0]), part, threshold, scratch,
                   corners);
      ASSERT_EQ(corners.size(), expected.size()) << "threshold " << threshold;
      for (std::size_t i = 0; i < corners.size(); ++i) {
        EXPECT_EQ(static_cast<float>(corners[i].x), expected[i].pt.x);
        EXPECT_EQ(static_cast<float>(corners[i].y), expected[i].pt.y);
      }
    }
  }
}

TEST(OrbCorners, OfAPartWithoutPixelsAreNone) {
  const cv::Mat grey = cv::Mat::zeros(40, 140, CV_8U);
  CornerScratch scratch;
  std::vector<Corner> corners;
  for (const Part part : {Part{10, 10, 10, 20}, Part{20, 10, 10, 20}, Part{10, 20, 10, 10}}) {
    find_corners(grey.ptr(), 140, part, 10, scratch, corners);
    EXPECT_TRUE(corners.empty());
  }
}

TEST(OrbPattern, LiesInThePatchAndComparesDifferentPoints) {
  const Pattern pattern = pattern_of_opencv();
  constexpr float kMost = 13.0F;
  for (std::size_t bit = 0; bit < kBits; ++bit) {
    for (const Pattern::Points* points : {&pattern.first, &pattern.second}) {
      EXPECT_LE(std::abs(points->x[bit]), kMost) << bit;
      EXPECT_LE(std::abs(points->y[bit]), kMost) << bit;
    }
    EXPECT_FALSE(pattern.first.x[bit] == pattern.second.x[bit] &&
                 pattern.first.y[bit] == pattern.second.y[bit])
        << bit;
  }
}

/// A keypoint by the pixel of its level, and all that is computed of it.
using Row = std::tuple<int, int, int, float, float, float, std::vector<std::uint8_t>>;

Row row_of(const cv::KeyPoint& keypoint, int x, int y, const cv::Mat& descriptors, int index) {
  const std::uint8_t* bytes = descriptors.ptr(index);
  return {keypoint.octave,        y, x, keypoint.size, keypoint.angle, keypoint.response,
          {bytes, bytes + kBytes}};
}

/// cv::ORB without a cap.
std::vector<Row> rows_of_opencv(const cv::Mat& grey, const Settings& settings) {
  std::vector<cv::KeyPoint> keypoints;
  cv::Mat descriptors;
  cv::ORB::create(1'000'000, static_cast<float>(settings.scale_factor), settings.levels,
                  settings.border_px, 0, 2, cv::ORB::HARRIS_SCORE, kPatchPx,
                  settings.fast_threshold)
      ->detectAndCompute(grey, cv::noArray(), keypoints, descriptors);
  std::vector<Row> rows;
  for (std::size_t i = 0; i < keypoints.size(); ++i) {
    const float scale = keypoints[i].size / kPatchPx;
    rows.push_back(row_of(keypoints[i], cvRound(keypoints[i].pt.x / scale),
                          cvRound(keypoints[i].pt.y / scale), descriptors, static_cast<int>(i)));
  }
  std::sort(rows.begin(), rows.end());
  return rows;
}

std::vector<Row> own_rows(const cv::Mat& grey, const Settings& settings, int threads) {
  Search search(settings);
  search.run(grey, nullptr, threads);
  std::vector<Row> rows;
  for (std::size_t i = 0; i < search.keypoints().size(); ++i) {
    const cv::KeyPoint& at = search.keypoints()[i];
    const float scale = at.size / kPatchPx;
    const double width = cvRound(static_cast<float>(grey.cols) / scale);
    const double height = cvRound(static_cast<float>(grey.rows) / scale);
    rows.push_back(row_of(at,
                          cvRound((static_cast<double>(at.pt.x) + 0.5) * width / grey.cols - 0.5),
                          cvRound((static_cast<double>(at.pt.y) + 0.5) * height / grey.rows - 0.5),
                          search.descriptors(), static_cast<int>(i)));
  }
  std::sort(rows.begin(), rows.end());
  return rows;
}

TEST(OrbAgreement, PlacesAnglesResponsesAndDescriptorsAreOpenCvsToTheBit) {
  std::vector<Settings> settings(4);
  settings[0].levels = 3;
  // Turned patches reach pixels beyond the level, which are not blurred.
  settings[1] = {.levels = 4, .scale_factor = 1.33, .fast_threshold = 1, .border_px = 16};
  settings[2] = {.levels = 2, .scale_factor = 2.0, .fast_threshold = 40, .border_px = 25};
  settings[3] = {.levels = 1, .fast_threshold = 20, .border_px = 31};
  for (Settings& each : settings) {
    each.max_keypoints = 0;
    for (const Image& image : {texture(217, 190, 41), noise(160, 131, 42)}) {
      const std::vector<Row> expected = rows_of_opencv(grey_of(image), each);
      EXPECT_GT(expected.size(), 20U);
      for (const int threads : {1, 3}) {
        EXPECT_TRUE(own_rows(grey_of(image), each, threads) == expected)
            << "border " << each.border_px << ", " << threads << " threads";
      }
    }
  }
}

}  // namespace
}  // namespace weft::orb
