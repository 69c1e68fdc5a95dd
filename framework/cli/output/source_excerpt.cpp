// SPDX-License-Identifier: Apache-2.0
#include "cli/output/source_excerpt.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cstdio>
#include <regex>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/quote.hpp>

#include "cli/output/colours.hpp"
#include "host/loading/secrets.hpp"

namespace weft::cli {
namespace {

constexpr std::size_t kMostBefore = 60, kMostShown = 90;  // [characters]

/// The characters of a line, each of one column; those that would disturb a terminal are blanks.
std::vector<std::string> characters_of(std::string_view line) {
  std::vector<std::string> characters;
  for (std::size_t i = 0; i < line.size();) {
    const std::size_t bytes = std::max<std::size_t>(utf8::decode(line, i).bytes, 1);
    const std::string character(line.substr(i, bytes));
    characters.push_back(escaped(character) == character ? character : " ");
    i += bytes;
  }
  return characters;
}

/// True if a word of the line names a secret, or an address in it may have a password.
bool may_have_secret(const std::string& line) {
  static const std::regex kWord("[A-Za-z0-9_]+");
  const auto is_secret = [](const std::smatch& word) { return host::is_secret(word.str()); };
  return (line.find("://") != line.npos && line.find('@') != line.npos) ||
         std::any_of(std::sregex_iterator(line.begin(), line.end(), kWord), {}, is_secret);
}

std::string excerpt(const std::string& label, const std::string& line, int column) {
  if (column < 1 || line.empty() || may_have_secret(line)) return "";
  const std::vector<std::string> characters = characters_of(line);
  const std::size_t caret = to_index(column) - 1;
  if (caret > characters.size()) return "";
  const std::size_t begin = caret > kMostBefore ? caret - kMostBefore : 0;
  const std::size_t end = std::min(begin + kMostShown, characters.size());
  std::string shown = begin > 0 ? "..." : "";
  const std::string blanks(shown.size() + caret - begin, ' ');
  for (std::size_t i = begin; i < end; ++i) shown += characters[i];
  if (end < characters.size()) shown += "...";
  const Colours colours = colours_of(stderr);
  return fmt::format("{:>5} | {}\n      | {}{}^{}\n", label, shown, blanks, colours.error,
                     colours.end);
}

}  // namespace

std::string source_excerpt(const std::string& file, yaml::Position at) {
  const auto text = yaml::read_text(file);
  if (!text || at.line < 1) return "";
  std::size_t begin = text->starts_with("\xEF\xBB\xBF") ? 3 : 0;
  for (int line = 1; line < at.line; ++line) {
    begin = text->find('\n', begin);
    if (begin++ == text->npos) return "";
  }
  std::string line = text->substr(begin, text->find('\n', begin) - begin);
  if (line.ends_with('\r')) line.pop_back();
  return excerpt(std::to_string(at.line), line, at.column);
}

std::string source_excerpt(std::string_view line, int column) {
  return excerpt("", std::string(line), column);
}

std::string source_excerpt(std::string_view where) {
  static const std::regex kPlace("^(.*?):([0-9]{1,7}):([0-9]{1,7})(: .*)?$");
  std::cmatch found;
  if (!std::regex_match(where.begin(), where.end(), found, kPlace)) return "";
  return source_excerpt(found[1].str(), {std::stoi(found[2]), std::stoi(found[3])});
}

}  // namespace weft::cli
