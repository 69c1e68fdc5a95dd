// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>
#include <weft/core/result.hpp>

#include "host/loading/registry.hpp"

namespace weft::cli {

// What a library says when it is loaded, which happens in a process of its own: this program anew.
// One that crashes, ends its process or hangs is an Error with what it did.

/// Whether an installed component can be loaded; fails as host::load().
Result<void> probe_component(const host::Installed& entry);

/// The manifest of a library, as YAML.
Result<std::string> probe_manifest(const std::string& library);

/// The devices on which an installed component could compute.
Result<std::vector<std::string>> probe_devices(const host::Installed& entry);

/// The other end: `arguments` are those of the program, of which the first is kProbe.
inline constexpr const char* kProbe = "--probe-plugin";
[[noreturn]] void answer_probe(const std::vector<std::string>& arguments);

}  // namespace weft::cli
