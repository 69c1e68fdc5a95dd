// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/core/result.hpp>

namespace weft::cli {

/// Exit codes of the program.
inline constexpr int kDone = 0;
inline constexpr int kFramesFailed = 1;
inline constexpr int kNotUsable = 1;      ///< exit code of doctor
inline constexpr int kDifferent = 1;      ///< exit code of replay
inline constexpr int kNotDetermined = 1;  ///< exit code of calibrate
inline constexpr int kBadConfiguration = 2;
inline constexpr int kInputOutput = 3;
inline constexpr int kComponentExited = 4;

/// Prints "error: where: message" to stderr, with the line of a place in a file below it.
void print_error(const Error& error);

}  // namespace weft::cli
