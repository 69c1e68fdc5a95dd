// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>
#include <weft/core/result.hpp>

namespace weft::host {

/// XXH128 of bytes, as 32 hexadecimal digits.
std::string content_hash(std::string_view bytes);

/// The files that a path names: one file, all files below a folder, or those that match where the
/// path has `*`, `?` or `[ ]`. In bytewise order. Fails with not_found when there are none.
Result<std::vector<std::string>> files_of(const std::string& path);

/// XXH128 of the files that a path names: their names without folders, and their contents. Where
/// the files stand does not matter.
Result<std::string> hash_of_files(const std::string& path);

}  // namespace weft::host
