// SPDX-License-Identifier: Apache-2.0
#include "yaml/quick_reader.hpp"

#include <algorithm>
#include <string>
#include <utility>

namespace weft::yaml::detail {
namespace {

/// Thrown where the text has something else.
struct Other {};

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

class QuickReader {
 public:
  explicit QuickReader(std::string_view text) : text_(text) {}

  Node document() {
    next_line();
    Node root = map(0);
    if (column_ != kEnd) throw Other{};
    return root;
  }

 private:
  static constexpr std::size_t kEnd = ~std::size_t{0};  ///< the column behind the last line
  static constexpr std::size_t kMostKeys = 64;          ///< keys of one map are compared in pairs
  static constexpr std::size_t kLongestKey = 100, kDeepest = 50;  ///< less than yaml-cpp takes

  char at(std::size_t offset) const { return offset < line_.size() ? line_[offset] : '\0'; }

  /// Goes to the next line that is neither empty nor a comment.
  void next_line() {
    do {
      if (rest_ >= text_.size()) {
        column_ = kEnd;
        return;
      }
      const std::size_t end = std::min(text_.find('\n', rest_), text_.size());
      line_ = text_.substr(rest_, end - rest_);
      rest_ = end + 1;
      ++number_;
      column_ = std::min(line_.find_first_not_of(' '), line_.size());
    } while (column_ == line_.size() || line_[column_] == '#');
  }

  Node node(Kind kind) {
    if (++nodes_ > kMaxNodes) throw Other{};
    Node made;
    made.kind = kind;
    made.at = {number_, static_cast<int>(column_) + 1};
    return made;
  }

  /// A plain text without spaces, of letters, digits and some signs that mean nothing.
  std::string_view word(std::string_view signs) {
    const std::size_t start = column_;
    while (is_letter(at(column_)) || is_digit(at(column_)) ||
           (column_ < line_.size() && signs.find(line_[column_]) != std::string_view::npos)) {
      ++column_;
    }
    const std::string_view found = line_.substr(start, column_ - start);
    const bool starts = !found.empty() && (is_letter(found[0]) || is_digit(found[0]) ||
                                           (found.size() > 1 && is_digit(found[1])));
    if (!starts || found == "null" || found == "Null" || found == "NULL") throw Other{};
    return found;
  }

  /// The map whose keys begin in this column, from the key on at which the line is.
  Node map(std::size_t column) {
    Node made = node(Kind::map);
    if (column_ != column || ++depth_ > kDeepest) throw Other{};
    while (column_ == column) {
      const Position key_at{number_, static_cast<int>(column_) + 1};
      std::string key(word(""));
      if (at(column_) != ':' || key.size() > kLongestKey || made.find(key) != nullptr ||
          made.entries.size() == kMostKeys) {
        throw Other{};
      }
      ++column_;
      if (column_ == line_.size()) {
        next_line();
        if (column_ == kEnd || column_ <= column) throw Other{};
        made.entries.push_back(
            {std::move(key), key_at, at(column_) == '-' ? list() : map(column_)});
      } else {
        if (line_[column_++] != ' ') throw Other{};
        made.entries.push_back({std::move(key), key_at, value()});
        if (column_ != line_.size()) throw Other{};
        next_line();
      }
    }
    if (column_ != kEnd && column_ > column) throw Other{};
    --depth_;
    return made;
  }

  /// A list of maps in block style.
  Node list() {
    const std::size_t column = column_;
    Node made = node(Kind::sequence);
    if (++depth_ > kDeepest) throw Other{};
    while (column_ == column) {
      if (at(column_) != '-' || at(column_ + 1) != ' ') throw Other{};
      column_ += 2;
      made.items.push_back(map(column_));
    }
    if (column_ != kEnd && column_ > column) throw Other{};
    --depth_;
    return made;
  }

  /// A value in the rest of the line.
  Node value() {
    if (at(column_) == '[') return short_list();
    if (at(column_) != '{') return scalar();
    Node made = node(Kind::map);
    if (at(++column_) != '}') throw Other{};
    ++column_;
    return made;
  }

  Node short_list() {
    Node made = node(Kind::sequence);
    ++column_;
    while (at(column_) != ']') {
      if (!made.items.empty()) {
        if (at(column_) != ',' || at(column_ + 1) != ' ') throw Other{};
        column_ += 2;
      }
      made.items.push_back(scalar());
      // Columns count characters.
      for (const char c : made.items.back().scalar) {
        if (static_cast<unsigned char>(c) >= 0x80) throw Other{};
      }
    }
    ++column_;
    return made;
  }

  Node scalar() {
    Node made = node(Kind::scalar);
    made.quoted = at(column_) == '"';
    if (!made.quoted) {
      made.scalar = word("+-./");
      return made;
    }
    while (at(++column_) != '"') {
      if (column_ >= line_.size()) throw Other{};
      if (line_[column_] == '\\' && at(++column_) != '"' && at(column_) != '\\') throw Other{};
      made.scalar += line_[column_];
    }
    ++column_;
    return made;
  }

  std::string_view text_, line_;
  std::size_t rest_ = 0;    ///< where the next line begins
  std::size_t column_ = 0;  ///< [bytes] of this line that are read
  int number_ = 0;          ///< number of this line, from 1
  std::size_t nodes_ = 0, depth_ = 0;
};

}  // namespace

std::optional<Node> read_quickly(std::string_view text) {
  if (text.find_first_of("\t\r") != std::string_view::npos) return std::nullopt;
  try {
    return QuickReader(text).document();
  } catch (const Other&) {
    return std::nullopt;
  }
}

}  // namespace weft::yaml::detail
