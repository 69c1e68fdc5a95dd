// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <weft/core/result.hpp>

namespace weft::live {

/// The token in a file, without the white space around it. As ssh does with keys, it refuses a file
/// of this user that other users can read. Files of other users, such as those that a container
/// mounts, are read as they are.
Result<std::string> token_in(const std::string& file);

}  // namespace weft::live
