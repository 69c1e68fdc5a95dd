// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <set>

#include "common/tests/blobs.hpp"

namespace weft::detectors {
namespace {

using testing::PluginUnderTest;

TEST(SiftOnBlobs, FindsBlobCentresWithoutBiasInEveryOctave) {
  PluginUnderTest plugin("detectors/sift", "{contrast_threshold: 0.01}");
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
}  // namespace weft::detectors
