// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace weft::yaml {

/// The legal form of a key's value.
enum class Form : std::uint8_t {
  text,      ///< any scalar
  texts,     ///< a list of these
  flag,      ///< true or false
  whole,     ///< a whole number from `low` to `high`
  number,    ///< any finite number
  positive,  ///< a number above 0
  choice,    ///< one of `choices`
  part,      ///< something with a special form, called `part`
};

/// A key that a map of a file may have. Tables of them are the one list that the strict reader of a
/// file and its JSON Schema share.
struct Key {
  std::string name;
  std::string help;                       ///< half a sentence for the author of the file
  Form form = Form::text;                 ///< form of the value
  std::int64_t low = 0, high = 0;         ///< legal range of an integer, inclusive
  std::vector<std::string> choices = {};  ///< [.] legal words
  std::string part = {};
  std::string fallback = {};  ///< the default as YAML; empty if there is none to show
  bool required = false;      ///< in a complete map, one that overrides no other map
};
using KeyTable = std::vector<Key>;

/// Builds a table key by key. required() and otherwise() are about the key before them.
class KeyTableBuilder {
 public:
  using Text = const char*;
  using Self = KeyTableBuilder&&;

  KeyTableBuilder() = default;
  explicit KeyTableBuilder(KeyTable first) : keys_(std::move(first)) {}

  Self text(Text name, Text help) && { return add({name, help, Form::text}); }
  Self texts(Text name, Text help) && { return add({name, help, Form::texts}); }
  Self flag(Text name, Text help) && { return add({name, help, Form::flag}); }
  Self number(Text name, Text help) && { return add({name, help, Form::number}); }
  Self positive(Text name, Text help) && { return add({name, help, Form::positive}); }
  Self whole(Text name, std::int64_t low, std::int64_t high, Text help) && {
    return add({name, help, Form::whole, low, high});
  }
  Self choice(Text name, std::vector<std::string> choices, Text help) && {
    return add({name, help, Form::choice, 0, 0, std::move(choices)});
  }
  Self part(Text name, Text part, Text help) && {
    return add({name, help, Form::part, 0, 0, {}, part});
  }
  Self all(const KeyTable& keys) && {
    keys_.insert(keys_.end(), keys.begin(), keys.end());
    return std::move(*this);
  }

  Self required() && {
    keys_.back().required = true;
    return std::move(*this);
  }
  Self otherwise(std::string fallback) && {
    keys_.back().fallback = std::move(fallback);
    return std::move(*this);
  }

  operator KeyTable() && { return std::move(keys_); }  // NOLINT(google-explicit-constructor)

 private:
  Self add(Key key) {
    keys_.push_back(std::move(key));
    return std::move(*this);
  }

  KeyTable keys_;
};

/// The names, in the order of the table.
std::vector<std::string> names_of(const KeyTable& table);

/// The key of this name, which the table must have.
const Key& key_of(const KeyTable& table, std::string_view name);

}  // namespace weft::yaml
