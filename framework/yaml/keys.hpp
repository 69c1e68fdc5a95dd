// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "yaml/yaml.hpp"

namespace weft::yaml {

/// Says that `entry` has a key that is none of the legal ones; `near` is the one that was probably
/// meant, or empty.
using UnknownKey = std::function<void(const Entry& entry, const std::string& near)>;

/// Reports each key of `map` that is none of `keys`, and puts what is clearly a misspelt one under
/// the key that it was meant for, where that is absent: so what it holds is checked too, and its
/// absence is not reported as well.
void correct_keys(Node& map, const std::vector<std::string>& keys, const UnknownKey& report);

}  // namespace weft::yaml
