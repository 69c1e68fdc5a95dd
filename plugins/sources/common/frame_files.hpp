// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>
#include <weft/core/result.hpp>

namespace weft::sources {

/// True if a file or folder of this name matches the pattern of one. An unfinished file of Weft,
/// NAME.<12 hexadecimal digits>.part (see UnfinishedFile), stays where its writer was killed: it
/// matches only patterns that end in ".part".
bool matches_name(const std::string& pattern, const std::string& name);

/// The files that match `pattern`, in natural order (see core/file_order.hpp). The wildcards * ?
/// and [ ] work in the file name and in folders, never across a '/', and do not match a leading
/// dot. A part of the path that exists literally is not a pattern. A match is an entry of a folder,
/// even if it cannot be read (a broken link, a folder, a pipe). Otherwise the next files would take
/// its place. An unfinished file matches only patterns that end in ".part". No match is an error
/// with its reason.
Result<std::vector<std::string>> matching_files(const std::string& pattern);

/// "gt/009_mdh301.csv" -> "009_mdh301".
std::string stem_of(const std::string& path);

}  // namespace weft::sources
