// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "common/tests/agreement.hpp"

namespace weft::detectors {
namespace {

using testing::PluginUnderTest;

/// Two views of one plane and the homography from pixels of the first to pixels of the second.
struct Views {
  Image first, second;
  cv::Matx33d second_from_first;
};

cv::Mat grey_of(const Image& image) {
  const auto height = static_cast<int>(image.pixels.dim(0));
  const auto width = static_cast<int>(image.pixels.dim(1));
  cv::Mat grey(height, width, image.pixels.ndim() == 3 ? CV_8UC3 : CV_8UC1,
               const_cast<std::uint8_t*>(image.pixels.data()));
  if (grey.channels() == 3) cv::cvtColor(grey, grey, cv::COLOR_BGR2GRAY);
  return grey.clone();
}

/// The image turned about its middle, made `scale` times as large and tilted, with noise and other
/// light. It is rendered at three times its size, so that fine texture does not alias.
Views views_of(const Image& image, double turn_rad, double scale, double tilt_per_px, Rng& rng) {
  constexpr int kFiner = 3;
  Views views;
  const cv::Mat grey = grey_of(image);
  const double x = 0.5 * (grey.cols - 1), y = 0.5 * (grey.rows - 1);
  const cv::Matx33d to_middle(1, 0, -x, 0, 1, -y, 0, 0, 1), back(1, 0, x, 0, 1, y, 0, 0, 1);
  const double c = scale * std::cos(turn_rad), s = scale * std::sin(turn_rad);
  const cv::Matx33d turned(c, -s, 0, s, c, 0, tilt_per_px, -0.5 * tilt_per_px, 1);
  views.second_from_first = back * turned * to_middle;
  const double offset = 0.5 * (kFiner - 1);
  const cv::Matx33d finer(kFiner, 0, offset, 0, kFiner, offset, 0, 0, 1);
  cv::Mat fine, seen;
  cv::warpPerspective(grey, fine, finer * views.second_from_first,
                      {kFiner * grey.cols, kFiner * grey.rows}, cv::INTER_CUBIC,
                      cv::BORDER_REFLECT_101);
  cv::resize(fine, seen, grey.size(), 0.0, 0.0, cv::INTER_AREA);
  const auto noisy = [&rng](const cv::Mat& of, double gain) {
    return image_of(of.cols, of.rows, [&](double u, double v) {
      return 20.0 + gain * of.at<std::uint8_t>(static_cast<int>(v), static_cast<int>(u)) +
             rng.normal();
    });
  };
  views.first = noisy(grey, 0.8);
  views.second = noisy(seen, 0.7);
  return views;
}

/// The result of searching for the first view's keypoints in the second one.
struct Quality {
  int visible = 0;     ///< keypoints of the first view that lie in the second
  int repeated = 0;    ///< those with a keypoint near them in the second view, of similar scale
  int correct = 0;     ///< matches by nearest neighbour and ratio that are right
  int mismatched = 0;  ///< and those that are not

  void operator+=(const Quality& other) {
    visible += other.visible;
    repeated += other.repeated;
    correct += other.correct;
    mismatched += other.mismatched;
  }
};

double squared_distance(const float* a, const float* b) {
  float sum = 0.0F;
  for (int i = 0; i < 128; ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return static_cast<double>(sum);
}

Quality quality(PluginUnderTest& plugin, const Views& views) {
  constexpr double kNearPx = 1.5, kRatio = 0.8, kSameKeypointPx = 3.0;
  const Keypoints first = detect(plugin, views.first), second = detect(plugin, views.second);
  const auto width = static_cast<double>(views.second.pixels.dim(1));
  const auto height = static_cast<double>(views.second.pixels.dim(0));
  Quality result;
  for (std::int64_t i = 0; i < first.count(); ++i) {
    const cv::Vec3d at =
        views.second_from_first * cv::Vec3d(first.xy_px(i, 0), first.xy_px(i, 1), 1.0);
    const double x = at[0] / at[2], y = at[1] / at[2];
    if (x < 5.0 || y < 5.0 || x > width - 6.0 || y > height - 6.0) continue;
    ++result.visible;
    const auto distance = [&](std::int64_t j) {
      return std::hypot(second.xy_px(j, 0) - x, second.xy_px(j, 1) - y);
    };
    std::int64_t best = -1;
    double nearest = 1e30;
    bool repeated = false;
    for (std::int64_t j = 0; j < second.count(); ++j) {
      repeated = repeated || distance(j) < kNearPx;
      const double d = squared_distance(first.descriptors.row(i), second.descriptors.row(j));
      if (d < nearest) nearest = d, best = j;
    }
    result.repeated += repeated ? 1 : 0;
    if (best < 0) continue;
    double next = 1e30;
    for (std::int64_t j = 0; j < second.count(); ++j) {
      if (std::hypot(second.xy_px(j, 0) - second.xy_px(best, 0),
                     second.xy_px(j, 1) - second.xy_px(best, 1)) < kSameKeypointPx) {
        continue;
      }
      next = std::min(next, squared_distance(first.descriptors.row(i), second.descriptors.row(j)));
    }
    if (nearest >= kRatio * kRatio * next) continue;
    ++(distance(best) < kNearPx ? result.correct : result.mismatched);
  }
  return result;
}

void expect_as_good(const std::string& params) {
  constexpr std::uint64_t kSeed = 61;
  std::printf("views from seed %d, %s\n", static_cast<int>(kSeed), params.c_str());
  Rng rng(kSeed);
  PluginUnderTest reference("detectors/sift", "{max_keypoints: 1000}");
  PluginUnderTest fast("detectors/sift_fast", params);
  Quality expected, found;
  const std::vector<Image> planes{texture(480, 360, 62), image_of_file(WEFT_TEXTURE, 480)};
  for (const Image& plane : planes) {
    for (int i = 0; i < 6; ++i) {
      const Views views = views_of(plane, rng.uniform(-0.6, 0.6), rng.uniform(0.6, 1.3),
                                   rng.uniform(-1e-3, 1e-3), rng);
      expected += quality(reference, views);
      found += quality(fast, views);
    }
  }
  const auto print = [](const char* name, const Quality& of) {
    std::printf("%s: %d keypoints, %.3f repeated, %d matches correct, %d not\n", name, of.visible,
                static_cast<double>(of.repeated) / of.visible, of.correct, of.mismatched);
  };
  print("sift", expected);
  print("sift_fast", found);
  EXPECT_GT(expected.correct, 3000);
  EXPECT_GT(found.correct, 0.95 * expected.correct);
  EXPECT_GT(found.correct * (expected.correct + expected.mismatched),
            0.99 * expected.correct * (found.correct + found.mismatched));
  EXPECT_GT(static_cast<double>(found.repeated) / found.visible,
            0.97 * static_cast<double>(expected.repeated) / expected.visible);
}

TEST(SiftFastQuality, MatchesViewsOfAPlaneAsOftenAsOpenCvsSift) {
#if defined(WEFT_SANITIZED)
  GTEST_SKIP() << "counts matches, in release alone";
#endif
  expect_as_good("{max_keypoints: 1000}");
}

}  // namespace
}  // namespace weft::detectors
