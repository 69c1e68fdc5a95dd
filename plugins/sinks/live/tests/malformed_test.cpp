// SPDX-License-Identifier: Apache-2.0
#include "malformed.hpp"

namespace weft::live {
namespace {

TEST_F(LiveMalformed, RequestsEndTheirClientAlone) { survive(2'000); }

}  // namespace
}  // namespace weft::live
