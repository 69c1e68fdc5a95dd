// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <weft/core/result.hpp>

#include "host/records/npz.hpp"

namespace weft::lab {

/// Registrations by frame; a frame that could not be measured has none.
using MeasuredFrames = std::map<std::uint64_t, host::RecordPtr>;

/// Writes the measurements of a finished run into its folder; replaces an earlier measurement.
Result<void> write_registrations(const std::string& folder, const MeasuredFrames& frames);

/// The output of write_registrations(); nothing where the run was not measured later. Fails where
/// the file is damaged.
Result<std::optional<MeasuredFrames>> read_registrations(const std::string& folder);

}  // namespace weft::lab
