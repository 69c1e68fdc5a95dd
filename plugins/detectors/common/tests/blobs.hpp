// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdio>
#include <optional>

#include "common/tests/scenes.hpp"

namespace weft::detectors {

/// A bright Gaussian blob, sampled at pixel centres.
inline Image blob_image(int side, double x, double y, double sigma_px) {
  return image_of(side, side, [&](double u, double v) {
    const double d2 = (u - x) * (u - x) + (v - y) * (v - y);
    return 20.0 + 220.0 * std::exp(-0.5 * d2 / (sigma_px * sigma_px));
  });
}

/// The strongest of the keypoints within a radius of a place, and of one octave where it is given;
/// -1 if there is none.
inline std::int64_t strongest_near(const Keypoints& keypoints, double x, double y, double radius_px,
                                   std::optional<int> octave) {
  std::int64_t best = -1;
  for (std::int64_t i = 0; i < keypoints.count(); ++i) {
    if (octave && keypoints.octave(i) != *octave) continue;
    if (std::hypot(keypoints.xy_px(i, 0) - x, keypoints.xy_px(i, 1) - y) > radius_px) continue;
    if (best < 0 || keypoints.response(i) > keypoints.response(best)) best = i;
  }
  return best;
}

/// The results for blobs of one size at places spread over the sampling lattice of the octaves.
struct BlobSeries {
  int found = 0;
  double mean_error_x_px = 0.0, mean_error_y_px = 0.0;
  double max_error_px = 0.0;
  double min_scale_ratio = 1e9, max_scale_ratio = 0.0;  ///< scale_px / sigma of the blob
  int octave = -9;
};

/// Looks at 36 blobs in images at least `side_px` wide, through the strongest keypoint within
/// `radius_px`, of `octave` if given, and prints what it sees.
inline BlobSeries look_at_blobs(testing::PluginUnderTest& plugin, double sigma_px,
                                double radius_px = 2.0, std::optional<int> octave = {},
                                int side_px = 80) {
  constexpr int kPlaces = 36;
  BlobSeries series;
  for (int i = 0; i < kPlaces; ++i) {
    const int side = std::max(side_px, static_cast<int>(14.0 * sigma_px));
    const double x = 0.5 * side + std::fmod(i * 16.0 * 0.6180339887, 16.0);
    const double y = 0.5 * side + std::fmod(i * 16.0 * 0.7548776662, 16.0);
    const Keypoints keypoints = detect(plugin, blob_image(side + 16, x, y, sigma_px));
    const std::int64_t k = strongest_near(keypoints, x, y, radius_px, octave);
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
  std::printf(
      "sigma %5.2f px octave %2d: mean error %+.4f %+.4f px, largest %.4f px, scale ratio %.3f to "
      "%.3f, %d found\n",
      sigma_px, series.octave, series.mean_error_x_px, series.mean_error_y_px, series.max_error_px,
      series.min_scale_ratio, series.max_scale_ratio, series.found);
  return series;
}

}  // namespace weft::detectors
