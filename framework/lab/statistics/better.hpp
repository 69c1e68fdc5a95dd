// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace weft::lab {

/// Which values of a metric are the better ones.
enum class Better { lower, higher };

}  // namespace weft::lab
