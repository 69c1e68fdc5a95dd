// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdio>
#include <string>

namespace weft::cli {

/// Escape sequences of a terminal; all are empty where text must stay plain.
struct Colours {
  std::string bold, accent, error, end;
};

/// Those of stdout or stderr. They are empty for files and pipes, for terminals without colours
/// (TERM unset or "dumb"), and where NO_COLOR is set (https://no-color.org).
Colours colours_of(std::FILE* stream);

}  // namespace weft::cli
