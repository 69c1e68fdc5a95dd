// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/abi.h>

#include <string>
#include <string_view>

namespace weft::host {

/// The error of a declared parameter that makes it unusable for pipelines or manifests; empty if
/// there is none. A parameter of an unknown type may come from a later version, and its value is
/// not checked.
std::string wrong_declaration(const weft_parameter& parameter);

/// The same of an array of a vendor's record type.
std::string wrong_field(const weft_field& field);

/// The name of the type in a manifest; null where this version of Weft has no such type.
const char* type_name(std::int32_t type);

bool is_utf8(std::string_view text);

}  // namespace weft::host
