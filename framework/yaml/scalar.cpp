// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <charconv>
#include <cstdio>
#include <limits>
#include <system_error>

#include "yaml/text.hpp"
#include "yaml/yaml.hpp"

namespace weft::yaml {
namespace {

// yaml-cpp takes only short texts in one line for a key.
constexpr std::size_t kLongestSimpleKey = 1000;

bool is_one_of(std::string_view text, std::initializer_list<std::string_view> words) {
  return std::find(words.begin(), words.end(), text) != words.end();
}

bool is_null_text(std::string_view text) {
  return is_one_of(text, {"", "~", "null", "Null", "NULL"});
}

std::optional<bool> bool_of(std::string_view text) {
  if (is_one_of(text, {"true", "True", "TRUE"})) return true;
  if (is_one_of(text, {"false", "False", "FALSE"})) return false;
  return std::nullopt;
}

std::size_t count_digits(std::string_view text) {
  return std::min(text.find_first_not_of("0123456789"), text.size());
}

std::string_view without_sign(std::string_view text) {
  return !text.empty() && (text[0] == '+' || text[0] == '-') ? text.substr(1) : text;
}

/// Digits of an integer of the core schema and their base; base 0 when it is none.
struct Digits {
  std::string_view text;
  int base = 0;
};

Digits digits_of(std::string_view text) {
  const auto all_in = [](std::string_view digits, const char* set) {
    return !digits.empty() && digits.find_first_not_of(set) == std::string_view::npos;
  };
  const std::string_view rest = text.substr(std::min<std::size_t>(2, text.size()));
  if (text.rfind("0x", 0) == 0 && all_in(rest, "0123456789abcdefABCDEF")) return {rest, 16};
  if (text.rfind("0o", 0) == 0 && all_in(rest, "01234567")) return {rest, 8};
  if (all_in(without_sign(text), "0123456789")) return {without_sign(text), 10};
  return {};
}

bool is_infinity(std::string_view text) {
  return is_one_of(without_sign(text), {".inf", ".Inf", ".INF"});
}

bool is_nan(std::string_view text) { return is_one_of(text, {".nan", ".NaN", ".NAN"}); }

/// [-+]? ( \. [0-9]+ | [0-9]+ ( \. [0-9]* )? ) ( [eE] [-+]? [0-9]+ )?
bool is_decimal(std::string_view text) {
  text = without_sign(text);
  const std::size_t whole = count_digits(text);
  text.remove_prefix(whole);
  if (!text.empty() && text[0] == '.') {
    const std::size_t fraction = count_digits(text.substr(1));
    if (whole + fraction == 0) return false;
    text.remove_prefix(1 + fraction);
  } else if (whole == 0) {
    return false;
  }
  if (text.empty()) return true;
  if (text[0] != 'e' && text[0] != 'E') return false;
  text = without_sign(text.substr(1));
  return !text.empty() && count_digits(text) == text.size();
}

/// True if the core schema reads this plain scalar as text.
bool is_text(std::string_view plain) {
  return !is_null_text(plain) && !bool_of(plain) && digits_of(plain).base == 0 &&
         !is_decimal(plain) && !is_infinity(plain) && !is_nan(plain);
}

bool is_plain(const Node& node) { return node.kind == Kind::scalar && !node.quoted; }

// Line separators are breaks to readers of YAML 1.1, so they are written as escapes.
bool needs_escape(char32_t value) {
  return !detail::is_printable(value) || value < 0x20 || value == 0x85 || value == 0x2028 ||
         value == 0x2029;
}

bool has_unsafe_character(std::string_view text) {
  for (std::size_t i = 0; i < text.size();) {
    const detail::CodePoint point = detail::decode(text, i);
    if (point.bytes == 0 || needs_escape(point.value)) return true;
    i += point.bytes;
  }
  return false;
}

/// True if a plain scalar in block style, anywhere in a line, is read back as this text.
bool stays_whole(std::string_view text) {
  const auto blank_at = [&](std::size_t i) { return i >= text.size() || text[i] == ' '; };
  if (text.empty() || blank_at(0) || text.back() == ' ') return false;
  if (std::string_view(",[]{}#&*!|>'\"%@`").find(text[0]) != std::string_view::npos) return false;
  if (std::string_view("-?:").find(text[0]) != std::string_view::npos && blank_at(1)) return false;
  const std::string_view start = text.substr(0, 3);
  if ((start == "---" || start == "...") && blank_at(3)) return false;
  if (text.back() == ':' || text.find(": ") != std::string_view::npos) return false;
  return text.find(" #") == std::string_view::npos && !has_unsafe_character(text);
}

void append_escaped(char32_t value, std::string& out) {
  switch (value) {
    case '\n':
      out += "\\n";
      return;
    case '\t':
      out += "\\t";
      return;
    case '\r':
      out += "\\r";
      return;
    default:
      break;
  }
  char escape[12];
  std::snprintf(escape, sizeof escape, value < 0x100 ? "\\x%02X" : "\\u%04X",
                static_cast<unsigned>(value));
  out += escape;
}

std::string in_quotes(std::string_view text) {
  std::string out = "\"";
  for (std::size_t i = 0; i < text.size();) {
    const detail::CodePoint point = detail::decode(text, i);
    if (point.bytes == 0) {
      out += "\xEF\xBF\xBD";
    } else if (point.value == '"' || point.value == '\\') {
      out += '\\';
      out += text[i];
    } else if (needs_escape(point.value)) {
      append_escaped(point.value, out);
    } else {
      out += text.substr(i, point.bytes);
    }
    i += std::max<std::size_t>(point.bytes, 1);
  }
  return out + '"';
}

std::string key_text(const std::string& key) {
  return is_text(key) && stays_whole(key) && key != "<<" ? key : in_quotes(key);
}

bool is_block(const Node& node) { return !node.items.empty() || !node.entries.empty(); }

/// A value that fits behind `key:` or `-` in one line.
std::string inline_text(const Node& node) {
  if (is_null(node)) return "null";
  if (node.kind == Kind::sequence) return "[]";
  if (node.kind == Kind::map) return "{}";
  const bool plain = (!node.quoted || is_text(node.scalar)) && stays_whole(node.scalar);
  return plain ? node.scalar : in_quotes(node.scalar);
}

/// Writes a collection whose first line is already indented.
void write_block(const Node& node, std::size_t indent, std::string& out) {
  bool first = true;
  const auto next_line = [&] {
    if (!first) out.append(indent, ' ');
    first = false;
  };
  for (const Node& item : node.items) {
    next_line();
    out += "- ";
    if (is_block(item)) {
      write_block(item, indent + 2, out);
    } else {
      out += inline_text(item) + '\n';
    }
  }
  for (const Entry& entry : node.entries) {
    next_line();
    const std::string key = key_text(entry.key);
    if (key.size() > kLongestSimpleKey) {
      out += "? " + key + '\n' + std::string(indent, ' ') + ':';
    } else {
      out += key + ':';
    }
    if (is_block(entry.value)) {
      out += '\n' + std::string(indent + 2, ' ');
      write_block(entry.value, indent + 2, out);
    } else {
      out += ' ' + inline_text(entry.value) + '\n';
    }
  }
}

}  // namespace

const Entry* Node::find_entry(std::string_view key) const {
  const auto same = [&](const Entry& entry) { return entry.key == key; };
  const auto found = std::find_if(entries.begin(), entries.end(), same);
  return found == entries.end() ? nullptr : &*found;
}

const Node* Node::find(std::string_view key) const {
  const Entry* entry = find_entry(key);
  return entry == nullptr ? nullptr : &entry->value;
}

bool operator==(const Node& a, const Node& b) {
  if (is_null(a) || is_null(b)) return is_null(a) && is_null(b);
  if (a.kind != b.kind) return false;
  if (a.kind == Kind::scalar) {
    return a.scalar == b.scalar && (a.quoted == b.quoted || is_text(a.scalar));
  }
  const auto same_entry = [](const Entry& x, const Entry& y) {
    return x.key == y.key && x.value == y.value;
  };
  return a.items == b.items && std::equal(a.entries.begin(), a.entries.end(), b.entries.begin(),
                                          b.entries.end(), same_entry);
}

bool is_null(const Node& node) {
  return node.kind == Kind::null || (is_plain(node) && is_null_text(node.scalar));
}

std::optional<bool> as_bool(const Node& node) {
  return is_plain(node) ? bool_of(node.scalar) : std::nullopt;
}

std::optional<std::int64_t> as_int64(const Node& node) {
  const Digits digits = is_plain(node) ? digits_of(node.scalar) : Digits{};
  if (digits.base == 0) return std::nullopt;
  const std::string text = (node.scalar[0] == '-' ? "-" : "") + std::string(digits.text);
  std::int64_t value = 0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), value, digits.base);
  if (read.ec != std::errc()) return std::nullopt;
  return value;
}

std::optional<double> as_double(const Node& node) {
  if (!is_plain(node)) return std::nullopt;
  std::string_view text = node.scalar;
  if (is_nan(text)) return std::numeric_limits<double>::quiet_NaN();
  if (is_infinity(text)) {
    const double infinity = std::numeric_limits<double>::infinity();
    return text[0] == '-' ? -infinity : infinity;
  }
  if (!is_decimal(text)) {
    const auto integer = as_int64(node);
    return integer ? std::optional<double>(static_cast<double>(*integer)) : std::nullopt;
  }
  if (text[0] == '+') text.remove_prefix(1);  // from_chars rejects a plus sign
  double value = 0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), value);
  if (read.ec != std::errc()) return std::nullopt;
  return value;
}

Node plain_node(std::string text, Position at) {
  Node node;
  node.kind = Kind::scalar;
  node.scalar = std::move(text);
  node.at = at;
  return node;
}

Node text_node(std::string text, Position at) {
  Node node = plain_node(std::move(text), at);
  node.quoted = true;
  return node;
}

std::string emit(const Node& node) {
  if (!is_block(node)) return inline_text(node) + '\n';
  std::string out;
  write_block(node, 0, out);
  return out;
}

}  // namespace weft::yaml
