// SPDX-License-Identifier: Apache-2.0
#include "malformed.hpp"

namespace weft::live {
namespace {

TEST_F(LiveMalformed, RequestsInGreatNumberEndTheirClientAlone) { survive(100'000); }

}  // namespace
}  // namespace weft::live
