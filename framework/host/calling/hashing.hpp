// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string_view>

#include "host/records/record.hpp"

namespace weft::host {

/// seed = XXH3_64(run_seed LE64, frame LE64, stage UTF-8, 0, nested path UTF-8).
std::uint64_t component_seed(std::uint64_t run_seed, std::uint64_t frame, std::string_view stage,
                             std::string_view nested_path, std::uint64_t draw = 0);

// Revisions are unique within one process. Components store derived data under the revision of a
// record, and all pipelines of the process may share them. The two highest bits encode the origin,
// so that a worker never makes a revision that its host has given it.
constexpr std::uint64_t kRevisionOfWorker = std::uint64_t{1} << 63U;
constexpr std::uint64_t kRevisionOfContent = std::uint64_t{1} << 62U;

/// A revision that depends on the content alone, which lies in host memory: equal in all processes.
std::uint64_t content_revision(const Record& record);

/// A revision that is new in this process. Safe from any thread.
std::uint64_t next_revision();

}  // namespace weft::host
