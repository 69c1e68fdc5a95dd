// SPDX-License-Identifier: Apache-2.0
#include "yaml/replace.hpp"

#include <algorithm>
#include <optional>
#include <tuple>
#include <weft/core/quote.hpp>

#include "yaml/text.hpp"

namespace weft::yaml {
namespace {

auto place_of(Position at) { return std::tuple(at.line, at.column); }

bool ends_word(char c) {
  const bool is_letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
  return !is_letter && !(c >= '0' && c <= '9') && c != '_';
}

/// Finds the start of the word whose value is at `offset`: there, or behind a quotation mark.
std::optional<std::size_t> find_word(const detail::Text& text, std::size_t offset,
                                     const std::string& word) {
  for (const std::size_t start : {offset, offset + 1}) {
    if (text.starts_at(start, word) && ends_word(text.at(start + word.size()))) return start;
  }
  return std::nullopt;
}

}  // namespace

Result<std::string> replaced(std::string_view text, std::vector<Replacement> replacements) {
  std::sort(replacements.begin(), replacements.end(),
            [](const auto& a, const auto& b) { return place_of(a.at) < place_of(b.at); });
  replacements.erase(std::unique(replacements.begin(), replacements.end()), replacements.end());
  const detail::Text known(text);
  const std::string_view bytes = known.bytes();
  std::string result(text.substr(0, text.size() - bytes.size()));  // a byte order mark
  std::size_t copied = 0, offset = 0;
  for (const Replacement& each : replacements) {
    while (offset < bytes.size() && place_of(known.position(offset)) < place_of(each.at)) {
      offset += std::max<std::size_t>(1, detail::decode(bytes, offset).bytes);
    }
    if (known.at(offset) == '*') continue;
    const auto start = find_word(known, offset, each.before);
    if (!start || *start < copied) {
      return Error{Errc::unsupported,
                   quote(each.before) + " cannot be replaced here: change it by hand",
                   std::to_string(each.at.line) + ":" + std::to_string(each.at.column)};
    }
    result += bytes.substr(copied, *start - copied);
    result += each.after;
    copied = *start + each.before.size();
  }
  return result + std::string(bytes.substr(copied));
}

}  // namespace weft::yaml
