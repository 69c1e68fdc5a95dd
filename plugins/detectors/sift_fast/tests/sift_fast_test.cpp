// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <set>

#include "common/tests/blobs.hpp"
#include "common/tests/detector_suite.hpp"

namespace weft::detectors {
namespace {

using testing::PluginUnderTest;

INSTANTIATE_TEST_SUITE_P(SiftFast, DetectorSuite,
                         ::testing::Values(DetectorCase{
                             "detectors/sift_fast", "contrast_threshold: 0.02", "sigma_px: 0.5"}));

TEST(SiftFastOnBlobs, FindsBlobCentresWithoutBiasInEveryOctave) {
  PluginUnderTest plugin("detectors/sift_fast", "{contrast_threshold: 0.01}");
  std::set<int> octaves;
  for (const double sigma_px : {1.7, 2.0, 2.7, 3.5, 5.0, 7.0, 10.0, 14.0, 20.0}) {
    const BlobSeries series = look_at_blobs(plugin, sigma_px);
    const double pitch_px = std::exp2(series.octave);
    octaves.insert(series.octave);
    EXPECT_NEAR(series.mean_error_x_px, 0.0, 0.05) << "sigma " << sigma_px;
    EXPECT_NEAR(series.mean_error_y_px, 0.0, 0.05) << "sigma " << sigma_px;
    EXPECT_LT(series.max_error_px, std::max(0.05, 0.035 * pitch_px)) << "sigma " << sigma_px;
  }
  EXPECT_THAT(octaves, ::testing::ElementsAre(-1, 0, 1, 2, 3));
}

TEST(SiftFastOnBlobs, ScaleIsTheSigmaOfABlob) {
  for (const char* params :
       {"{contrast_threshold: 0.01}", "{contrast_threshold: 0.01, octave_layers: 5}"}) {
    PluginUnderTest plugin("detectors/sift_fast", params);
    for (const double sigma_px : {1.7, 2.7, 5.0, 10.0}) {
      const BlobSeries series = look_at_blobs(plugin, sigma_px);
      EXPECT_GT(series.min_scale_ratio, 0.95) << params << " sigma " << sigma_px;
      EXPECT_LT(series.max_scale_ratio, 1.05) << params << " sigma " << sigma_px;
    }
  }
}

TEST(SiftFastOnBlobs, FindsPlaceAndScaleInTheImageAsItIs) {
  PluginUnderTest plugin("detectors/sift_fast", "{contrast_threshold: 0.01, upsample: false}");
  std::set<int> octaves;
  for (const double sigma_px : {2.7, 3.5, 5.0, 10.0, 14.0}) {
    const BlobSeries series = look_at_blobs(plugin, sigma_px);
    octaves.insert(series.octave);
    EXPECT_NEAR(series.mean_error_x_px, 0.0, 0.05) << sigma_px;
    EXPECT_NEAR(series.mean_error_y_px, 0.0, 0.05) << sigma_px;
    EXPECT_LT(series.max_error_px, std::max(0.05, 0.035 * std::exp2(series.octave))) << sigma_px;
    EXPECT_GT(series.min_scale_ratio, 0.95) << sigma_px;
    EXPECT_LT(series.max_scale_ratio, 1.05) << sigma_px;
  }
  EXPECT_EQ(*octaves.begin(), 0);
}

}  // namespace
}  // namespace weft::detectors
