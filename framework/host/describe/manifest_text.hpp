// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/abi.h>

#include <ostream>
#include <string>
#include <string_view>

namespace weft::host {

/// A double-quoted YAML scalar.
std::string double_quoted(std::string_view text);

/// As short as it can be without being another number; infinities as YAML writes them.
std::string number(double value);

/// The words of a text as a YAML list.
std::string words(std::string_view text);

/// A parameter that wrong_declaration() finds nothing wrong with, as an item of `parameters`.
void write_parameter(std::ostream& out, const weft_parameter& parameter);

/// A field that wrong_field() finds nothing wrong with, as a YAML map.
std::string text_of(const weft_field& field);

}  // namespace weft::host
