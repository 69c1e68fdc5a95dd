// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "yaml/yaml.hpp"

namespace weft::cli {

/// The line of a place in a file, and a caret below its column:
///
///      8 | filters: {alfa_s: 0.2}
///        |           ^
///
/// Long lines are cut around the caret. Nothing is returned for an empty line, for one that may
/// have a secret, and for a file that cannot be read again, such as a pipe.
std::string source_excerpt(const std::string& file, yaml::Position at);

/// The same for a text of one line, such as a setting of the command line.
std::string source_excerpt(std::string_view line, int column);

/// The same for the `where` of an Error, "FILE:LINE:COLUMN", also with ": ID" behind it; empty for
/// all others.
std::string source_excerpt(std::string_view where);

}  // namespace weft::cli
