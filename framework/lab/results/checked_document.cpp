// SPDX-License-Identifier: Apache-2.0
#include "lab/results/checked_document.hpp"

#include <utility>

#include "host/records/content_hash.hpp"

namespace weft::lab {
namespace {

using nlohmann::json;

constexpr const char* kCheck = "check";

/// Keys sorted, no blanks.
std::string canonical(const json& object) {
  return object.dump(-1, ' ', false, json::error_handler_t::replace);
}

}  // namespace

std::string checked_document(nlohmann::ordered_json object, int indent) {
  const auto text = [&](int step) {
    return object.dump(step, ' ', false, json::error_handler_t::replace);
  };
  object[kCheck] = host::content_hash(canonical(json::parse(text(-1))));
  return text(indent) + "\n";
}

Result<void> compare_check(json object, const std::string& file) {
  const auto found = object.find(kCheck);
  if (found == object.end()) return {};
  const json check = *found;
  object.erase(found);
  if (check == host::content_hash(canonical(object))) return {};
  return Error{Errc::invalid_data, "was changed after it was written", file};
}

}  // namespace weft::lab
