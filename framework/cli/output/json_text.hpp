// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>

#include "yaml/yaml.hpp"

namespace weft::cli {

/// Prints JSON with a line break at its end; bytes that are no UTF-8 are replaced.
void print_json(const nlohmann::ordered_json& json);

/// YAML as JSON: numbers, booleans and null keep their types, all other values become text.
nlohmann::ordered_json to_json(const yaml::Node& node);

}  // namespace weft::cli
