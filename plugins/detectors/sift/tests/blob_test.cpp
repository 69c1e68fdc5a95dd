// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cstdio>
#include <set>

#include "tests/scenes.hpp"

namespace weft::sift {
namespace {

using testing::PluginUnderTest;

Image blob_image(double x, double y, double sigma_px) {
  const int side = std::max(80, static_cast<int>(14.0 * sigma_px)) + 16;
  return image_of(side, side, [&](double u, double v) {
    const double d2 = (u - x) * (u - x) + (v - y) * (v - y);
    return 20.0 + 220.0 * std::exp(-0.5 * d2 / (sigma_px * sigma_px));
  });
}

/// The strongest keypoint within 2 px of a place; -1 if there is none.
std::int64_t strongest_near(const Keypoints& keypoints, double x, double y) {
  std::int64_t best = -1;
  for (std::int64_t i = 0; i < keypoints.count(); ++i) {
    if (std::hypot(keypoints.xy_px(i, 0) - x, keypoints.xy_px(i, 1) - y) > 2.0) continue;
    if (best < 0 || keypoints.response(i) > keypoints.response(best)) best = i;
  }
  return best;
}

/// What came of blobs of one size at places spread over the sampling lattice of the octaves.
struct BlobSeries {
  int found = 0;
  double mean_error_x_px = 0.0, mean_error_y_px = 0.0;
  double max_error_px = 0.0;
  double min_scale_ratio = 1e9, max_scale_ratio = 0.0;
  int octave = -9;
};

BlobSeries look_at_blobs(PluginUnderTest& plugin, double sigma_px) {
  constexpr int kPlaces = 36;
  BlobSeries series;
  for (int i = 0; i < kPlaces; ++i) {
    const int side = std::max(80, static_cast<int>(14.0 * sigma_px));
    const double x = 0.5 * side + std::fmod(i * 16.0 * 0.6180339887, 16.0);
    const double y = 0.5 * side + std::fmod(i * 16.0 * 0.7548776662, 16.0);
    const Keypoints keypoints = detect(plugin, blob_image(x, y, sigma_px));
    const std::int64_t k = strongest_near(keypoints, x, y);
    if (k < 0) continue;
    const double dx = keypoints.xy_px(k, 0) - x, dy = keypoints.xy_px(k, 1) - y;
    ++series.found;
    series.mean_error_x_px += dx;
    series.mean_error_y_px += dy;
    series.max_error_px = std::max({series.max_error_px, std::abs(dx), std::abs(dy)});
    const double ratio = keypoints.scale_px(k) / sigma_px;
    series.min_scale_ratio = std::min(series.min_scale_ratio, ratio);
    series.max_scale_ratio = std::max(series.max_scale_ratio, ratio);
    series.octave = keypoints.octave(k);
  }
  series.mean_error_x_px /= series.found;
  series.mean_error_y_px /= series.found;
  EXPECT_GT(series.found, kPlaces / 2) << "sigma " << sigma_px;
  return series;
}

TEST(SiftOnBlobs, FindsBlobCentresWithoutBiasInEveryOctave) {
  PluginUnderTest plugin("detectors/sift", "{contrast_threshold: 0.01}");
  std::set<int> octaves;
  for (const double sigma_px : {1.7, 2.0, 2.7, 3.5, 5.0, 7.0, 10.0, 14.0, 20.0}) {
    const BlobSeries series = look_at_blobs(plugin, sigma_px);
    const double pitch_px = std::exp2(series.octave);
    octaves.insert(series.octave);
    std::printf("sigma %4.1f px octave %2d: mean error %+.4f %+.4f px, largest %.4f px\n", sigma_px,
                series.octave, series.mean_error_x_px, series.mean_error_y_px, series.max_error_px);
    EXPECT_NEAR(series.mean_error_x_px, 0.0, 0.05) << "sigma " << sigma_px;
    EXPECT_NEAR(series.mean_error_y_px, 0.0, 0.05) << "sigma " << sigma_px;
    EXPECT_LT(series.max_error_px, std::max(0.05, 0.035 * pitch_px)) << "sigma " << sigma_px;
  }
  EXPECT_THAT(octaves, ::testing::ElementsAre(-1, 0, 1, 2, 3));
}

TEST(SiftOnBlobs, ScaleIsTheSigmaOfABlob) {
  for (const char* params :
       {"{contrast_threshold: 0.01}", "{contrast_threshold: 0.01, octave_layers: 5}"}) {
    PluginUnderTest plugin("detectors/sift", params);
    for (const double sigma_px : {1.7, 2.7, 5.0, 10.0}) {
      const BlobSeries series = look_at_blobs(plugin, sigma_px);
      EXPECT_GT(series.min_scale_ratio, 0.95) << params << " sigma " << sigma_px;
      EXPECT_LT(series.max_scale_ratio, 1.05) << params << " sigma " << sigma_px;
    }
  }
}

}  // namespace
}  // namespace weft::sift
