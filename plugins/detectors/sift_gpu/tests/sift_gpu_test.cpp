// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cmath>
#include <vector>

#include "common/tests/blobs.hpp"
#include "common/tests/detector_suite.hpp"

namespace weft::detectors {
namespace {

using testing::PluginUnderTest;

INSTANTIATE_TEST_SUITE_P(SiftGpu, DetectorSuite,
                         ::testing::Values(DetectorCase{
                             "detectors/sift_gpu", "contrast_threshold: 0.02", "sigma_px: 0.5"}));

/// With three layers an octave o answers to blobs of sigma 1.6 * 2^(o + t), 1/3 < t < 4/3: each
/// layer to those between its own blur and the next one's.
int octave_of_blob(double sigma_px) {
  return static_cast<int>(std::floor(std::log2(sigma_px / 1.6) - 1.0 / 3.0));
}

TEST(SiftGpuOnBlobs, FindsPlaceScaleAndOctaveWithTheImageEnlargedAndWithout) {
  const std::vector<double> small{1.7, 2.7, 5.0}, small_and_large{1.7, 2.7, 5.0, 10.0};
  for (const bool upsample : {true, false}) {
    const std::string params =
        "{contrast_threshold: 0.01, upsample: " + std::string(upsample ? "true" : "false") + "}";
    std::printf("%s\n", params.c_str());
    PluginUnderTest plugin("detectors/sift_gpu", params);
    for (const double sigma_px : upsample ? small : small_and_large) {
      const int octave = octave_of_blob(sigma_px);
      if (octave < (upsample ? -1 : 0)) {
        const Keypoints none = detect(plugin, blob_image(80, 40.2, 39.6, sigma_px));
        EXPECT_EQ(strongest_near(none, 40.2, 39.6, 2.0, {}), -1) << "it is too small";
        continue;
      }
      const BlobSeries series = look_at_blobs(plugin, sigma_px, 2.0, octave);
      // Of 36. Half way between two samples the steps of the refinement may go to and fro, those
      // of OpenCV's SIFT too.
      EXPECT_GE(series.found, 27) << sigma_px;
      EXPECT_NEAR(series.mean_error_x_px, 0.0, 0.05) << sigma_px;
      EXPECT_NEAR(series.mean_error_y_px, 0.0, 0.05) << sigma_px;
      EXPECT_LT(series.max_error_px, std::max(0.05, 0.035 * std::exp2(octave))) << sigma_px;
      EXPECT_GT(series.min_scale_ratio, 0.95) << sigma_px;
      EXPECT_LT(series.max_scale_ratio, 1.05) << sigma_px;
    }
  }
}

}  // namespace
}  // namespace weft::detectors
