// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "yaml/yaml.hpp"

namespace weft::yaml {

/// A word of a text and what replaces it.
struct Replacement {
  Position at;
  std::string before, after;
  bool operator==(const Replacement&) const = default;
};

/// The text with each word replaced at its position; every other byte stays. A word may be quoted.
/// The value of an alias (`*name`) is replaced at its anchor only. Fails with unsupported at
/// "line:column" if the text has another word there, such as an escaped one.
Result<std::string> replaced(std::string_view text, std::vector<Replacement> replacements);

}  // namespace weft::yaml
