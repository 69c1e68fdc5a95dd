// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "yaml/key_table.hpp"

namespace weft::schema {

using nlohmann::ordered_json;

/// Schemas of values with a special form, by Key::part.
using Parts = std::map<std::string, ordered_json>;

/// {"type": ...}, one or several: "object", "null".
ordered_json of_type(const std::vector<std::string>& types);

/// Any scalar, and a list of them: readers of texts take `3` and `true` too.
ordered_json text();
ordered_json texts();

/// One of these texts.
ordered_json one_of(const std::vector<std::string>& choices);

/// {"$ref": ...} to a definition of the same schema.
ordered_json reference(const std::string& definition);

/// {"if": the map has `key` with this value, "then": ...}.
ordered_json where(const std::string& key, const ordered_json& value, ordered_json then);

/// The keys of a table, each with its help, form and default. Throws std::out_of_range where a form
/// is none of `parts`.
ordered_json properties_of(const yaml::KeyTable& table, const Parts& parts);

/// A map of these keys and no others.
ordered_json map_of(const yaml::KeyTable& table, const Parts& parts);

/// The names of the keys that a complete map has.
ordered_json required_of(const yaml::KeyTable& table);

}  // namespace weft::schema
