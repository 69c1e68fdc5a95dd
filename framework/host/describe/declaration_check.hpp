// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/abi.h>

#include <string>
#include <string_view>

namespace weft::host {

/// What is wrong with a parameter that a component declares, so that no pipeline could use it as it
/// is or no manifest hold it; empty where nothing is. One of an unknown type is a later version's
/// and may be: its value is not looked at.
std::string wrong_declaration(const weft_parameter& parameter);

/// The same of an array of a vendor's record type.
std::string wrong_field(const weft_field& field);

/// The name of the type in a manifest; null where this version of Weft has no such type.
const char* type_name(std::int32_t type);

bool is_utf8(std::string_view text);

}  // namespace weft::host
