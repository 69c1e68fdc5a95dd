// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>
#include <weft/core/result.hpp>

namespace weft::host {

// What a library says when it is loaded, which happens in a process of its own: in a copy of this
// one. A library that crashes, ends its process or hangs is an Error with what it did. It is not
// heard: what it prints to stdout is dropped. For programs that have no threads yet.

/// Whether a library has a component and can be loaded; fails as load().
Result<void> probe_component(const std::string& library, const std::string& id);

/// The manifest of a library, as YAML. Its first component must be `first`, where that is not
/// empty.
Result<std::string> probe_manifest(const std::string& library, std::string_view first = {});

/// The devices on which a component of a library could compute.
Result<std::vector<std::string>> probe_devices(const std::string& library, const std::string& id);

}  // namespace weft::host
