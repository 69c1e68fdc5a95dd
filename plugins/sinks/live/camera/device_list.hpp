// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/capture_devices/capture_devices.hpp"

namespace weft::live {

/// The JSON of /cameras.json, see protocol.md.
std::string device_list(const std::vector<capture_devices::Device>& devices);

}  // namespace weft::live
