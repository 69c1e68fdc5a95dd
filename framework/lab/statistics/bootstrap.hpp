// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "lab/statistics/unknown.hpp"

namespace weft::lab {

/// 95 % interval of a mean of independently resampled values [n]: bias-corrected and accelerated
/// bootstrap (Efron and Tibshirani 1993, section 14.3) of 2,000 resamples, acceleration by the
/// jackknife. Unknown for fewer than 6 values. Values are finite.
Interval bootstrap_interval(std::span<const double> values, std::uint64_t seed = 1);

}  // namespace weft::lab
