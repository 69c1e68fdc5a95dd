// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>
#include <weft/core/result.hpp>

namespace weft::cli {

/// The arguments of the program, with `~/`, `$NAME/` and `${NAME}/` expanded where one begins with
/// it, or its value does behind `--option=`. A shell leaves these to the program in `--out=~/run`
/// and in quotes. Fails on `~user` and on a variable that is not set.
Result<std::vector<std::string>> expand_arguments(int argc, const char* const* argv);

}  // namespace weft::cli
