// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lab/calibration/coverage.hpp"
#include "lab/calibration/solution.hpp"

namespace weft::calibration {

inline constexpr std::size_t kFewestViews = 8;

/// Why views cannot determine the camera, with what to do; nothing where they may.
std::optional<std::string> refusal_of(const std::vector<View>& views, const ImageSize& size);

/// Why a solution is not to be trusted, with what to do; nothing where it is.
std::optional<std::string> refusal_of(const Solution& solution, const ImageSize& size);

}  // namespace weft::calibration
