// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace weft::yaml {

/// What the value of a key must be.
enum class Form : std::uint8_t {
  text,      ///< any scalar
  texts,     ///< a list of these
  flag,      ///< true or false
  whole,     ///< a whole number from `low` to `high`
  number,    ///< any finite number
  positive,  ///< a number above 0
  choice,    ///< one of `choices`
  part,      ///< something with a form of its own, called `part`
};

/// A key that a map of a file may have. Tables of them are the one list that the strict reader of a
/// file and its JSON Schema share.
struct Key {
  std::string name;
  std::string help;        ///< half a sentence for who writes the file
  Form form = Form::text;  ///< of the value
  std::int64_t low = 0, high = 0;
  std::vector<std::string> choices = {};
  std::string part = {};
  std::string fallback = {};  ///< the default as YAML; empty: there is none to tell
  bool required = false;      ///< of a map that is complete, not laid over another one
};
using KeyTable = std::vector<Key>;

/// The names, in the order of the table.
std::vector<std::string> names_of(const KeyTable& table);

/// The key of this name, which the table must have.
const Key& key_of(const KeyTable& table, std::string_view name);

}  // namespace weft::yaml
