// SPDX-License-Identifier: Apache-2.0
#include "common/tests/detector_suite.hpp"
#include "common/tests/sift_blob_suite.hpp"

namespace weft::detectors {
namespace {

INSTANTIATE_TEST_SUITE_P(SiftFast, DetectorSuite,
                         ::testing::Values(DetectorCase{
                             "detectors/sift_fast", "contrast_threshold: 0.02", "sigma_px: 0.5"}));

INSTANTIATE_TEST_SUITE_P(SiftFast, SiftOnBlobs, ::testing::Values("detectors/sift_fast"));
INSTANTIATE_TEST_SUITE_P(SiftFast, SiftOnBlobsNotEnlarged,
                         ::testing::Values("detectors/sift_fast"));

}  // namespace
}  // namespace weft::detectors
