// SPDX-License-Identifier: Apache-2.0
#include "yaml/builder.hpp"

#include <yaml-cpp/mark.h>

#include <algorithm>
#include <string_view>
#include <utility>
#include <weft/core/index.hpp>
#include <weft/core/quote.hpp>
#include <weft/core/suggest.hpp>

namespace weft::yaml::detail {
namespace {

constexpr std::string_view kCoreTag = "tag:yaml.org,2002:";

std::size_t offset_of(const YAML::Mark& mark) { return to_index(std::max(mark.pos, 0)); }

/// Values and depth of a tree; adds to both.
void measure(const Node& node, std::size_t depth, std::size_t& nodes, std::size_t& deepest) {
  ++nodes;
  if (node.kind == Kind::sequence || node.kind == Kind::map) ++depth;
  deepest = std::max(deepest, depth);
  for (const Node& item : node.items) measure(item, depth, nodes, deepest);
  for (const Entry& entry : node.entries) measure(entry.value, depth, nodes, deepest);
}

/// The text of a quoted scalar. yaml-cpp gives the escapes `\N` (U+0085) and `\_` (U+00A0) as the
/// one byte 85 or A0, which is no UTF-8.
std::string in_utf8(const std::string& value) {
  std::string text;
  text.reserve(value.size());
  for (std::size_t i = 0; i < value.size();) {
    const CodePoint point = decode(value, i);
    const std::size_t bytes = std::max<std::size_t>(point.bytes, 1);
    if (point.bytes == 0) text += '\xC2';
    text.append(value, i, bytes);
    i += bytes;
  }
  return text;
}

void move_to(Position at, Node& node) {
  node.at = at;
  for (Node& item : node.items) move_to(at, item);
  for (Entry& entry : node.entries) {
    entry.at = at;
    move_to(at, entry.value);
  }
}

/// The last character before `offset` that is neither blank nor in a line of comment.
std::size_t last_before(const Text& text, std::size_t offset) {
  while (true) {
    const std::size_t last = text.bytes().substr(0, offset).find_last_not_of(" \t\r\n");
    if (last == std::string_view::npos) return 0;
    offset = text.line_start(last);
    if (text.at(text.bytes().find_first_not_of(" \t", offset)) != '#') return last;
  }
}

/// True if only comments follow the last document end mark (`...`) before `offset`.
bool follows_end_mark(const Text& text, std::size_t offset) {
  const std::size_t start = text.line_start(last_before(text, offset));
  return start < text.line_start(offset) && text.starts_at(start, "...");
}

}  // namespace

std::string with_question_marks(std::string text) {
  std::replace(text.begin(), text.end(), kQuestionMark, '?');
  return text;
}

std::string Builder::unknown_anchor(const std::string& name) const {
  const std::string near = nearest(name, anchor_names_);
  std::string hint;
  if (!near.empty()) hint = "; did you mean " + quote("*" + near) + "?";
  if (near.empty()) hint = "; quote a text that begins with '*'";
  if (!name.empty() && name.back() == ':') hint = "; put a space before the ':'";
  return "no anchor " + quote("&" + name) + " precedes this alias" + hint;
}

void Builder::problem(Position at, std::string message) {
  document_.problems.push_back({at, std::move(message)});
}

bool Builder::expects_key() const {
  return !open_.empty() && open_.back().node.kind == Kind::map && !open_.back().has_key;
}

std::size_t Builder::begin(const YAML::Mark& mark) {
  const std::size_t offset = offset_of(mark);
  if ((open_.empty() || !open_.back().flow) && text_.is_indented_by_tab(offset)) {
    throw Fault{offset, "a tab in the indentation; indent with spaces"};
  }
  if (!expects_key() && ++nodes_ > kMaxNodes) {
    problem(text_.position(offset), "more than " + std::to_string(kMaxNodes) + " values");
    throw Stop{};
  }
  return offset;
}

void Builder::OnDocumentStart(const YAML::Mark& mark) {
  const std::size_t offset = offset_of(mark);
  if (std::exchange(started_, true)) {
    if (!text_.has_start_mark(offset) && !follows_end_mark(text_, offset)) {
      throw Fault{offset,
                  "this does not belong to the value before it; check the indentation, and quote "
                  "a text as a whole"};
    }
    problem(text_.position(offset), "more than one document; put it into a separate file");
    throw Stop{};
  }
}

void Builder::OnAnchor(const YAML::Mark&, const std::string& name) {
  anchor_names_.push_back(with_question_marks(name));
}

void Builder::refuse_missing_value(std::size_t offset) const {
  if (open_.empty()) return;
  const Frame& parent = open_.back();
  // yaml-cpp takes a line without ':' for a key, and gives its value the place of the key.
  if (!parent.flow && parent.has_key && offset == parent.key_offset) {
    const std::string key = parent.drops_value ? "this key" : quote(parent.key);
    throw Fault{offset, "expected ':' behind " + key};
  }
  if (parent.flow && parent.node.kind == Kind::sequence && text_.at(offset) == ',') {
    throw Fault{offset, "an empty value between commas; remove a comma"};
  }
}

Position Builder::place_of_null(std::size_t offset) const {
  // yaml-cpp gives an empty value the place of whatever comes next.
  const Position at = text_.position(offset);
  if (open_.empty()) return text_.at(offset) == '~' || text_.at(offset) == 'n' ? at : Position{};
  const Frame& parent = open_.back();
  const bool in_map = parent.node.kind == Kind::map;
  const Position owner = in_map ? parent.key_at : parent.node.at;
  const bool inside = parent.flow || at.column > owner.column || (in_map && at.line == owner.line);
  if (inside && std::string_view("~nN&!").find(text_.at(offset)) != std::string_view::npos) {
    return at;
  }
  if (in_map) return owner;
  return parent.flow ? at : text_.position(last_before(text_, offset));
}

void Builder::OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) {
  const std::size_t offset = offset_of(mark);
  refuse_missing_value(offset);
  if (!expects_key() && ++nodes_ > kMaxNodes) {
    problem(text_.position(offset), "more than " + std::to_string(kMaxNodes) + " values");
    throw Stop{};
  }
  Node node;
  node.at = expects_key() ? text_.position(offset) : place_of_null(offset);
  deliver(std::move(node), offset, anchor);
}

void Builder::OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                       const std::string& value) {
  const std::size_t offset = begin(mark);
  check_tag(tag, Kind::scalar, offset);
  const bool quoted = tag != "?";
  std::string given = with_question_marks(value);
  Node node = plain_node(quoted ? in_utf8(given) : std::move(given), text_.position(offset));
  node.quoted = quoted;
  if (value.find('\0') != std::string::npos) {
    problem(node.at, "a text with the character NUL, which ends names and paths; remove it");
  }
  deliver(std::move(node), offset, anchor);
}

void Builder::check_tag(const std::string& tag, Kind kind, std::size_t offset) {
  if (tag.empty() || tag == "?") return;
  const bool core = tag.rfind(kCoreTag, 0) == 0;
  const std::string name = core ? tag.substr(kCoreTag.size()) : std::string();
  const std::string shown = core ? "!!" + name : tag;
  // yaml-cpp ends a tag at the first character that cannot belong to it: `!!stré` before the é.
  if (shown[0] == '!' && text_.starts_at(offset, shown) &&
      std::string_view(" \t\r\n,]}\0", 8).find(text_.at(offset + shown.size())) ==
          std::string_view::npos) {
    throw Fault{offset, "put a space behind the tag " + quote(shown)};
  }
  constexpr std::string_view kFitting[] = {"null", "str", "seq", "map"};
  if (tag == "!" || name == kFitting[to_index(kind)]) return;
  const bool known = name == "str" || name == "seq" || name == "map";
  problem(text_.position(offset),
          "tag " + quote(shown) +
              (known ? " does not fit this value; remove it"
                     : " is not supported (only !!str, !!seq, !!map); remove it"));
}

void Builder::start(Kind kind, const YAML::Mark& mark, const std::string& tag,
                    YAML::anchor_t anchor, YAML::EmitterStyle::value style) {
  const std::size_t offset = begin(mark);
  if (open_.size() >= kMaxDepth) {
    problem(text_.position(offset), "nested deeper than " + std::to_string(kMaxDepth) + " levels");
    throw Stop{};
  }
  check_tag(tag, kind, offset);
  Frame frame;
  frame.node.kind = kind;
  frame.node.at = text_.position(offset);
  frame.anchor = anchor;
  frame.offset = offset;
  frame.flow = style == YAML::EmitterStyle::Flow || (!open_.empty() && open_.back().flow);
  open_.push_back(std::move(frame));
}

void Builder::OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                              YAML::EmitterStyle::value style) {
  start(Kind::sequence, mark, tag, anchor, style);
}

void Builder::OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                         YAML::EmitterStyle::value style) {
  start(Kind::map, mark, tag, anchor, style);
}

void Builder::end() {
  Frame frame = std::move(open_.back());
  open_.pop_back();
  deliver(std::move(frame.node), frame.offset, frame.anchor);
}

void Builder::OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) {
  const std::size_t offset = begin(mark);
  const Position at = text_.position(offset);
  const auto found = anchored_.find(anchor);
  if (found == anchored_.end()) {
    problem(at, "an alias inside the value of the anchor that it names");
    Node node;
    node.at = at;
    return deliver(std::move(node), offset, 0);
  }
  const Anchored& target = found->second;
  const std::size_t added = target.nodes - 1;  // begin() counted the first
  if (nodes_ + added > kMaxNodes || open_.size() + target.depth > kMaxDepth) {
    const bool many = nodes_ + added > kMaxNodes;
    problem(at, many ? "more than " + std::to_string(kMaxNodes) + " values with this alias expanded"
                     : "nested deeper than " + std::to_string(kMaxDepth) +
                           " levels with this alias expanded");
    throw Stop{};
  }
  nodes_ += added;
  Node node = target.node;
  move_to(at, node);
  deliver(std::move(node), offset, 0);
}

void Builder::deliver(Node node, std::size_t offset, YAML::anchor_t anchor) {
  if (anchor != 0) {
    Anchored& target = anchored_[anchor];
    measure(node, 0, target.nodes, target.depth);
    target.node = node;
  }
  if (open_.empty()) {
    document_.root = std::move(node);
    return;
  }
  Frame& parent = open_.back();
  if (parent.node.kind == Kind::sequence) {
    parent.node.items.push_back(std::move(node));
  } else if (!parent.has_key) {
    take_key(parent, std::move(node), offset);
  } else {
    parent.has_key = false;
    if (parent.drops_value) return;
    parent.node.entries.push_back({std::move(parent.key), parent.key_at, std::move(node)});
  }
}

void Builder::take_key(Frame& map, Node node, std::size_t offset) {
  map.has_key = true;
  map.drops_value = true;
  map.key_at = node.at;
  map.key_offset = offset;
  if (node.kind != Kind::scalar) {
    map.node.unclear = true;
    problem(node.at, node.kind == Kind::null ? "a key is missing or null; write a text, or quote it"
                                             : "a key must be a text, not a list or map");
    return;
  }
  if (node.scalar == "<<" && !node.quoted) {
    map.node.unclear = true;
    problem(node.at, "merge keys ('<<') are not supported; write the keys out");
    return;
  }
  const auto [first, is_new] = map.keys.emplace(node.scalar, node.at);
  if (!is_new) {
    const auto same = [&](const Entry& entry) { return entry.key == node.scalar; };
    std::find_if(map.node.entries.begin(), map.node.entries.end(), same)->unclear = true;
    problem(node.at, "duplicate key " + quote(node.scalar) + "; the first is at " +
                         std::to_string(first->second.line) + ":" +
                         std::to_string(first->second.column));
    return;
  }
  map.drops_value = false;
  map.key = std::move(node.scalar);
}

}  // namespace weft::yaml::detail
