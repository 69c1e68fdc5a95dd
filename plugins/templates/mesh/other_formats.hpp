// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace weft::mesh {

/// A sentence about a file whose first bytes are neither OBJ nor PLY: its format, and how to
/// convert it. Empty where nothing contradicts OBJ.
std::string other_format(std::string_view bytes);

/// The same by the ending of its name, for a file that could not be read as OBJ.
std::string other_format_by_name(const std::string& path);

}  // namespace weft::mesh
