// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>
#include <weft/core/result.hpp>

namespace weft::images {

/// The files of a pattern by the stem that each shares with its frame; none for an empty pattern.
/// `parameter` is the pattern's in messages. Fails on a pattern without files, on a file without a
/// frame, on two of a frame and on two frames with one stem.
Result<std::map<std::string, std::string>> files_by_stem(const std::string& parameter,
                                                         const std::string& pattern,
                                                         const std::vector<std::string>& stems);

}  // namespace weft::images
