// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string_view>

#include "host/records/record.hpp"

namespace weft::host {

/// seed = XXH3_64(run_seed LE64, frame LE64, stage UTF-8, 0, nested path UTF-8).
std::uint64_t component_seed(std::uint64_t run_seed, std::uint64_t frame, std::string_view stage,
                             std::string_view nested_path, std::uint64_t draw = 0);

/// A revision that depends on the content alone.
std::uint64_t content_revision(const Record& record);

}  // namespace weft::host
