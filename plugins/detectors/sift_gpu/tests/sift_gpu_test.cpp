// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/features2d.hpp>

#include "common/tests/blobs.hpp"
#include "common/tests/detector_suite.hpp"

namespace weft::detectors {
namespace {

using testing::PluginUnderTest;

INSTANTIATE_TEST_SUITE_P(SiftGpu, DetectorSuite,
                         ::testing::Values(DetectorCase{
                             "detectors/sift_gpu", "contrast_threshold: 0.02", "sigma_px: 0.5"}));

}  // namespace
}  // namespace weft::detectors
