// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>
#include <weft/core/result.hpp>

/// A strict reader of YAML 1.2 (core schema, one document) that keeps every position, and the
/// writer that belongs to it.
namespace weft::yaml {

inline constexpr std::size_t kMaxNodes = 10'000;     ///< [values] after alias expansion
inline constexpr std::size_t kMaxDepth = 100;        ///< [collections inside one another]
inline constexpr std::size_t kMaxBytes = 2u << 20u;  ///< [bytes] of text

/// A place in a text, both from 1. Columns count characters (Unicode code points, a tab is one);
/// a byte order mark is not counted.
struct Position {
  int line = 1;
  int column = 1;
  int source = 0;  ///< index of the text, where a document is made from several
  bool operator==(const Position&) const = default;

  /// The position of errors of an unreadable file; its line is 0.
  static Position whole_file(int source) { return {0, 0, source}; }
};

/// "file:line:column", or "file" of a whole file.
std::string place(std::string_view file, Position at);

/// The place in the `where` of an Error of parse.
Position position_in(std::string_view where, std::string_view file);

enum class Kind : std::uint8_t { null, scalar, sequence, map };

struct Entry;

/// A value. An empty value is null and has the position of its key.
///
/// An `unclear` node, here and in readers of nodes, has contents that a reported error leaves
/// unknown. A reader does not report mere consequences of that error.
struct Node {
  Kind kind = Kind::null;
  std::string scalar;       ///< the text of a scalar, escapes resolved, UTF-8
  bool quoted = false;      ///< quoted, a block scalar, or tagged !!str: always text, never typed
  Position at;              ///< first character; a value from an alias has the alias's position
  std::vector<Node> items;  ///< items of a sequence
  std::vector<Entry> entries;  ///< entries of a map, in the order of the text, keys unique
  bool unclear = false;        ///< a map with a rejected key, so that a missing key may be a
                               ///< consequence

  /// The value of `key`, or null when this is no map or has no such key.
  const Node* find(std::string_view key) const;
  const Entry* find_entry(std::string_view key) const;
};

/// One `key: value`. Keys are text, whatever they look like: `009: x` has the key "009".
struct Entry {
  std::string key;
  Position at;  ///< position of the key
  Node value;
  bool unclear = false;  ///< the text gives the key again; this is the first value
};

/// Sets the source of all positions in a node.
void set_source(Node& node, int source);

/// Same content, wherever it stands. Quoting counts only where it decides the type: `"a"` equals
/// `a`, but `"1"` differs from `1`. Scalars are compared as written: `1.0` differs from `1.00`.
bool operator==(const Node& a, const Node& b);

/// An error in a text that can be parsed.
struct Problem {
  Position at;
  std::string message;
};

/// Use `root` only when there are no problems.
struct Document {
  Node root;
  std::string file;
  std::vector<Problem> problems;  ///< in the order of the text
};

/// The bytes of a file that is to be parsed; see read_text_file.
Result<std::string> read_text(const std::string& file);

/// Reads one document; an empty text is a null root. A line break missing at the end is added.
///
/// A text that is no YAML gives Errc::syntax at "file:line:column", alone: invalid UTF-8 or control
/// characters, bad indentation, a missing quote or bracket. All other errors are collected in
/// `problems`:
/// - duplicate keys, merge keys (`<<`), keys that are not text;
/// - more than one document, directives other than `%YAML 1.2`;
/// - tags other than !!str !!seq !!map, aliases without an anchor;
/// - texts with a NUL character, which would truncate a name or a path.
///
/// Too many nodes or too deep nesting end the reading and are the last problem.
Result<Document> parse(std::string_view text, std::string file_name);

/// A scalar that is text whatever it holds, as if it stood in quotes.
Node text_node(std::string text, Position at = {});

/// A scalar whose type its text decides, as if it stood without quotes.
Node plain_node(std::string text, Position at = {});

/// Empty, `~`, `null`, `Null` or `NULL`, not quoted.
bool is_null(const Node& node);

/// `true True TRUE false False FALSE`, not quoted; yes, no, on and off are text.
std::optional<bool> as_bool(const Node& node);

/// Decimal with optional sign (leading zeros stay decimal), 0x or 0o, not quoted; nothing when it
/// does not fit.
std::optional<std::int64_t> as_int64(const Node& node);

/// Any integer of as_int64 or a decimal fraction, `.inf` and `.nan` (the caller decides about
/// them), not quoted; nothing when out of the range of double. Does not depend on the locale.
std::optional<double> as_double(const Node& node);

/// Writes a node as block-style YAML, such that parse(emit(node)) equals `node` (within the limits
/// of parse). Scalars are plain unless that would change their type or break the text; bytes that
/// are no UTF-8 become U+FFFD.
std::string emit(const Node& node);

}  // namespace weft::yaml
