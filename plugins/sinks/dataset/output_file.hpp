// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>
#include <weft/core/result.hpp>
#include <weft/data/image.hpp>
#include <weft/data/npz_members.hpp>

namespace weft::dataset {

// Each writes under a temporary name first, so that no half-written file bears the final one, and
// fails with the path and the reason. They do not wait for the disk: see sync_file_system().

/// [H,W] or [H,W,3] as PNG, without loss.
Result<void> write_png(const std::filesystem::path& path, const Array<std::uint8_t>& pixels);

/// An archive of the members, uncompressed and without dates: equal members give equal bytes.
Result<void> write_npz(const std::filesystem::path& path, const std::vector<NpzMember>& members);

}  // namespace weft::dataset
