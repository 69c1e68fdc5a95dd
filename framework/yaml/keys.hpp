// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "yaml/yaml.hpp"

namespace weft::yaml {

/// Reports that `entry` has an unknown key; `near` is the probably intended one, or empty.
using UnknownKey = std::function<void(const Entry& entry, const std::string& near)>;

/// Reports each key of `map` that is none of `keys`. A clearly misspelt key is moved to the
/// intended key if that is absent. Its value is then checked too, and the absence of the intended
/// key is not reported as well.
void correct_keys(Node& map, const std::vector<std::string>& keys, const UnknownKey& report);

}  // namespace weft::yaml
