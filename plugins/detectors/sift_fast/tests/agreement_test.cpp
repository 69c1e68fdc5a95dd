// SPDX-License-Identifier: Apache-2.0
#include "common/tests/sift_agreement_suite.hpp"

namespace weft::detectors {
namespace {

/// The rest are extrema that hardly are any: a hundredth of a grey level decides about them.
constexpr LikeSift kSiftFast{"detectors/sift_fast", 0.9, 3.0};

INSTANTIATE_TEST_SUITE_P(SiftFast, SiftAgreement,
                         ::testing::Combine(::testing::Values(kSiftFast),
                                            ::testing::ValuesIn(kSiftSettings)));
INSTANTIATE_TEST_SUITE_P(SiftFast, SiftAgreementOnRecordedData, ::testing::Values(kSiftFast));

}  // namespace
}  // namespace weft::detectors
