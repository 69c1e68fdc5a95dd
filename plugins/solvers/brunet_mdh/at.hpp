// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <cstddef>
#include <weft/core/index.hpp>

namespace weft::brunet_mdh {

/// A vertex, row or face as an index of a standard container.
constexpr std::size_t at(std::integral auto index) { return to_index(index); }

}  // namespace weft::brunet_mdh
