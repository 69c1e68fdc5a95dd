// SPDX-License-Identifier: Apache-2.0
#include "cli/output/json_text.hpp"

#include <fmt/core.h>

#include <cmath>

namespace weft::cli {

using nlohmann::ordered_json;

void print_json(const ordered_json& json) {
  fmt::print("{}\n", json.dump(2, ' ', false, ordered_json::error_handler_t::replace));
}

ordered_json to_json(const yaml::Node& node) {
  if (node.kind == yaml::Kind::sequence) {
    ordered_json list = ordered_json::array();
    for (const yaml::Node& item : node.items) list.push_back(to_json(item));
    return list;
  }
  if (node.kind == yaml::Kind::map) {
    ordered_json map = ordered_json::object();
    for (const yaml::Entry& entry : node.entries) map[entry.key] = to_json(entry.value);
    return map;
  }
  if (yaml::is_null(node)) return nullptr;
  if (const auto flag = yaml::as_bool(node)) return *flag;
  if (const auto whole = yaml::as_int64(node)) return *whole;
  const auto number = yaml::as_double(node);
  if (number && std::isfinite(*number)) return *number;
  return node.scalar;
}

}  // namespace weft::cli
