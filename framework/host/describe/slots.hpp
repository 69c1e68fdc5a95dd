// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/abi.h>

#include <set>
#include <string>

namespace weft::host {

/// The error of a component's kAbout if it names inputs or outputs that its role does not have, or
/// an empty text. Unknown roles are not checked, nor are optional inputs of a newer library.
std::string unknown_slots(const weft_component& component, bool is_newer);

/// The same for a component whose role leaves its slots open; `records` are the known record types.
std::string wrong_open_slots(const weft_component& component, const std::set<std::string>& records);

}  // namespace weft::host
