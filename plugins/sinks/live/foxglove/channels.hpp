// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "hub.hpp"

namespace weft::live::foxglove {

/// A stream of messages that clients may subscribe to; its number is its position from 1 on.
struct Channel {
  std::string_view topic, schema;
  /// JSON of a frame; empty where it has none.
  std::string (*message)(ShownFrame& frame, const LiveSetup& setup);
};

/// Image, mesh, camera, transforms, report.
const std::array<Channel, 5>& channels();

/// The schema of that name, as JSON Schema: those members of the published ones that are sent.
std::string schema_of(std::string_view name);

std::string server_info();
std::string advertisement();
/// `level` is 0 for information, 1 for a warning.
std::string status(int level, const std::string& message);
/// The bytes before the JSON of a message.
std::string data_head(std::uint32_t subscription, std::uint64_t time_ns);

}  // namespace weft::live::foxglove
