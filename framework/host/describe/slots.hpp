// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/abi.h>

#include <set>
#include <string>

namespace weft::host {

/// What a component's kAbout says of inputs or outputs that its role does not have, or an empty
/// text. Of a role that there is not, nothing is said; nor of an optional input of a newer library.
std::string unknown_slots(const weft_component& component, bool is_newer);

/// The same of a component whose role leaves its slots open, which knows these record types.
std::string wrong_open_slots(const weft_component& component, const std::set<std::string>& records);

}  // namespace weft::host
