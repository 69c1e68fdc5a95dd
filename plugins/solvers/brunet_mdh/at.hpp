// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <cstddef>

namespace weft::brunet_mdh {

/// A vertex, row or face as an index of a standard container.
constexpr std::size_t at(std::integral auto index) { return static_cast<std::size_t>(index); }

}  // namespace weft::brunet_mdh
