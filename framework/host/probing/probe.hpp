// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>
#include <weft/core/result.hpp>

namespace weft::host {

// The description of a library, which is loaded in a copy of this process. A library that crashes,
// ends its process or hangs is an Error that describes the cause. Its output to stdout is dropped.
// The calling program must have no other threads.

/// Checks that a library has a component and can be loaded; fails as load().
Result<void> probe_component(const std::string& library, const std::string& id);

/// The manifest of a library, as YAML. Its first component must be `first`, where that is not
/// empty.
Result<std::string> probe_manifest(const std::string& library, std::string_view first = {});

/// The devices on which a component of a library could compute.
Result<std::vector<std::string>> probe_devices(const std::string& library, const std::string& id);

}  // namespace weft::host
