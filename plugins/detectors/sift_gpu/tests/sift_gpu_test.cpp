// SPDX-License-Identifier: Apache-2.0
#include "common/tests/detector_suite.hpp"
#include "common/tests/sift_blob_suite.hpp"

namespace weft::detectors {
namespace {

INSTANTIATE_TEST_SUITE_P(SiftGpu, DetectorSuite,
                         ::testing::Values(DetectorCase{
                             "detectors/sift_gpu", "contrast_threshold: 0.02", "sigma_px: 0.5"}));
INSTANTIATE_TEST_SUITE_P(SiftGpu, SiftOnBlobs, ::testing::Values("detectors/sift_gpu"));
INSTANTIATE_TEST_SUITE_P(SiftGpu, SiftOnBlobsNotEnlarged, ::testing::Values("detectors/sift_gpu"));

}  // namespace
}  // namespace weft::detectors
