// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>
#include <weft/core/result.hpp>

namespace weft::sources {

/// A file inside an archive.
struct ArchiveMember {
  std::string name, bytes;
};

/// The members of an npz file that `wanted` by their names, in the order of the archive, each whole
/// and with the right checksum. Fails, with the file, on one that is no archive, is damaged, or
/// would unpack to far more than its size.
Result<std::vector<ArchiveMember>> read_npz_file(const std::string& path,
                                                 bool (*wanted)(std::string_view name));

}  // namespace weft::sources
