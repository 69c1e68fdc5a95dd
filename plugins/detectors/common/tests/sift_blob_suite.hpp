// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gmock/gmock.h>

#include <cmath>
#include <set>
#include <string>

#include "common/tests/blobs.hpp"

namespace weft::detectors {

/// The tests for every detector of SIFT keypoints, by its id; a test program instantiates it with
/// its detector.
class SiftOnBlobs : public ::testing::TestWithParam<const char*> {};
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(SiftOnBlobs);

/// For those that can take the image as it is.
class SiftOnBlobsNotEnlarged : public ::testing::TestWithParam<const char*> {};
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(SiftOnBlobsNotEnlarged);

/// With three layers an octave o answers to blobs of sigma 1.6 * 2^(o + t), 1/3 < t < 4/3: each
/// layer to those between its own blur and the next one's.
inline int octave_of_blob(double sigma_px) {
  return static_cast<int>(std::floor(std::log2(sigma_px / 1.6) - 1.0 / 3.0));
}

inline void expect_places(const BlobSeries& series, double sigma_px) {
  const double pitch_px = std::exp2(octave_of_blob(sigma_px));
  // 27 out of 36. Half way between two samples the steps of the refinement may alternate, as those
  // of OpenCV's SIFT do.
  EXPECT_GE(series.found, 27) << "sigma " << sigma_px;
  EXPECT_NEAR(series.mean_error_x_px, 0.0, 0.05) << "sigma " << sigma_px;
  EXPECT_NEAR(series.mean_error_y_px, 0.0, 0.05) << "sigma " << sigma_px;
  EXPECT_LT(series.max_error_px, std::max(0.05, 0.035 * pitch_px)) << "sigma " << sigma_px;
}

inline void expect_scales(const BlobSeries& series, double sigma_px) {
  EXPECT_GT(series.min_scale_ratio, 0.95) << "sigma " << sigma_px;
  EXPECT_LT(series.max_scale_ratio, 1.05) << "sigma " << sigma_px;
}

TEST_P(SiftOnBlobs, FindsBlobCentresWithoutBiasInEveryOctave) {
  testing::PluginUnderTest plugin(GetParam(), "{contrast_threshold: 0.01}");
  std::set<int> octaves;
  for (const double sigma_px : {1.7, 2.0, 2.7, 3.5, 5.0, 7.0, 10.0, 14.0, 20.0}) {
    octaves.insert(octave_of_blob(sigma_px));
    expect_places(look_at_blobs(plugin, sigma_px, 2.0, octave_of_blob(sigma_px)), sigma_px);
  }
  EXPECT_THAT(octaves, ::testing::ElementsAre(-1, 0, 1, 2, 3));
}

TEST_P(SiftOnBlobs, ScaleIsTheSigmaOfABlob) {
  for (const char* params :
       {"{contrast_threshold: 0.01}", "{contrast_threshold: 0.01, octave_layers: 5}"}) {
    SCOPED_TRACE(params);
    testing::PluginUnderTest plugin(GetParam(), params);
    for (const double sigma_px : {1.7, 2.7, 5.0, 10.0}) {
      expect_scales(look_at_blobs(plugin, sigma_px), sigma_px);
    }
  }
}

TEST_P(SiftOnBlobsNotEnlarged, FindsPlaceAndScaleInTheImageAsItIs) {
  testing::PluginUnderTest plugin(GetParam(), "{contrast_threshold: 0.01, upsample: false}");
  for (const double sigma_px : {2.7, 3.5, 5.0, 10.0, 14.0}) {
    const BlobSeries series = look_at_blobs(plugin, sigma_px, 2.0, octave_of_blob(sigma_px));
    expect_places(series, sigma_px);
    expect_scales(series, sigma_px);
  }
  const Keypoints none = detect(plugin, blob_image(80, 40.2, 39.6, 1.7));
  EXPECT_EQ(strongest_near(none, 40.2, 39.6, 2.0, {}), -1) << "it is too small";
}

}  // namespace weft::detectors
