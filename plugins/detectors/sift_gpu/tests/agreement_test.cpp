// SPDX-License-Identifier: Apache-2.0
#include "common/tests/sift_agreement_suite.hpp"

namespace weft::detectors {
namespace {

constexpr LikeSift kSiftGpu{"detectors/sift_gpu", 0.99, 1.0};

INSTANTIATE_TEST_SUITE_P(SiftGpu, SiftAgreement,
                         ::testing::Combine(::testing::Values(kSiftGpu),
                                            ::testing::ValuesIn(kSiftSettings)));
INSTANTIATE_TEST_SUITE_P(SiftGpu, SiftAgreementOnRecordedData, ::testing::Values(kSiftGpu));

}  // namespace
}  // namespace weft::detectors
