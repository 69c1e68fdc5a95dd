// SPDX-License-Identifier: Apache-2.0
#include "yaml/yaml.hpp"

#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include <algorithm>
#include <exception>
#include <sstream>
#include <utility>
#include <weft/core/index.hpp>
#include <weft/core/quote.hpp>
#include <weft/core/text_file.hpp>

#include "yaml/builder.hpp"
#include "yaml/quick_reader.hpp"
#include "yaml/text.hpp"

namespace weft::yaml {
namespace {

using detail::Builder;
using detail::Fault;
using detail::Text;

// Each one costs a fresh start of the parser.
constexpr std::size_t kMaxUnknownAnchors = 16;

struct Saying {
  const char* library;
  const char* ours;
};

// The beginning of yaml-cpp's message, and its meaning for the author of the text.
const Saying kSayings[] = {
    {YAML::ErrorMsg::END_OF_MAP_FLOW, "expected ',' or '}' inside { }"},
    {YAML::ErrorMsg::END_OF_SEQ_FLOW, "expected ',' or ']' inside [ ]"},
    {YAML::ErrorMsg::END_OF_MAP,
     "expected 'key: value' here; check the indentation, and quote a text as a whole"},
    {YAML::ErrorMsg::END_OF_SEQ, "expected '- value' here; check the indentation"},
    {YAML::ErrorMsg::FLOW_END, "this bracket closes nothing that is open"},
    {YAML::ErrorMsg::MAP_VALUE,
     "':' is not expected here; check the indentation, and quote text that holds ': '"},
    {YAML::ErrorMsg::MAP_KEY, "'?' is not expected here"},
    {YAML::ErrorMsg::BLOCK_ENTRY,
     "'- ' is not expected here; start the list on a new line, or write it inside [ ]"},
    {YAML::ErrorMsg::TAB_IN_INDENTATION, "a tab in the indentation; indent with spaces"},
    {YAML::ErrorMsg::EOF_IN_SCALAR, "a quote is not closed"},
    {YAML::ErrorMsg::DOC_IN_SCALAR, "a quote is not closed before the document ends"},
    {YAML::ErrorMsg::ALIAS_NOT_FOUND, "'*' needs the name of an anchor; quote text with '*'"},
    {YAML::ErrorMsg::ANCHOR_NOT_FOUND, "'&' needs the name of an anchor; quote text with '&'"},
    {YAML::ErrorMsg::UNKNOWN_TOKEN, "no plain value can start or go on with this; quote the value"},
    {YAML::ErrorMsg::INVALID_ESCAPE, "unknown escape; double the backslash, or use single quotes"},
};

/// Separators of texts inside { } and [ ].
constexpr std::string_view kAround = " \t\r\n,[]{}";

/// True if a bracket follows a text without a space, such as in `{path: frames/[0-9].png}`.
bool is_bracket_in_text(const Text& text, std::size_t offset) {
  return offset > 0 && std::string_view("[]{}").find(text.at(offset)) != std::string_view::npos &&
         kAround.find(text.at(offset - 1)) == std::string_view::npos;
}

std::string explain(const std::string& message, const Text& text, std::size_t offset) {
  if (offset > 0 && text.at(offset) == '{' && text.at(offset - 1) == '$') {
    return "'{' is not expected here; quote ${...} inside { } and [ ]";
  }
  const bool by_tab = text.is_indented_by_tab(
      std::min(text.bytes().find_first_not_of(" \t", text.line_start(offset)), offset));
  std::string result = message;
  for (const Saying& saying : kSayings) {
    if (message.rfind(saying.library, 0) == 0) {
      result = saying.ours;
      break;
    }
  }
  if (is_bracket_in_text(text, offset)) result += "; quote a text that holds a bracket";
  if (by_tab && result.find("tab") == std::string::npos) result += "; indent with spaces, not tabs";
  return result;
}

/// The text as yaml-cpp gets it. Without the end mark it would itself close a quote that is open
/// at the end. Inside { } and [ ] yaml-cpp ends a plain text at any '?', which YAML does not: one
/// that is no indicator of a key is replaced, see detail::kQuestionMark.
std::string feed_of(std::string_view bytes) {
  const bool ends_line = !bytes.empty() && bytes.back() == '\n';
  std::string feed = std::string(bytes) + (ends_line ? "...\n" : "\n...\n");
  for (std::size_t i = feed.find('?'); i != std::string::npos; i = feed.find('?', i + 1)) {
    const bool starts = i == 0 || kAround.find(feed[i - 1]) != std::string_view::npos;
    const bool ends = kAround.find(feed[i + 1]) != std::string_view::npos;
    if (!(starts && ends)) feed[i] = detail::kQuestionMark;
  }
  return feed;
}

/// Replaces the alias at `offset` by an empty value; returns its name.
std::string drop_alias(std::string& feed, std::size_t offset) {
  const std::size_t end = std::min(feed.find_first_of(" \t\r\n,[]{}", offset), feed.size());
  std::string name = detail::with_question_marks(feed.substr(offset + 1, end - offset - 1));
  const bool is_key = name.size() > 1 && name.back() == ':';
  std::string filler = is_key ? "'':" : "''";
  filler.resize(end - offset, ' ');
  feed.replace(offset, end - offset, filler);
  return name;
}

struct Ended {
  std::optional<Fault> fault;
  bool unknown_anchor = false;  ///< the fault is only an alias without an anchor
};

Ended run(const std::string& feed, const Text& text, Builder& builder) {
  try {
    std::istringstream in(feed);
    YAML::Parser parser(in);
    while (parser.HandleNextDocument(builder)) {
    }
  } catch (const detail::Stop&) {
  } catch (const Fault& fault) {
    return {fault, false};
  } catch (const YAML::Exception& error) {
    const bool placed = error.mark.pos >= 0;
    const std::size_t offset = placed ? to_index(error.mark.pos) : feed.size();
    const bool unknown = error.msg.rfind(YAML::ErrorMsg::UNKNOWN_ANCHOR, 0) == 0;
    const bool at_dollar = offset > 0 && text.at(offset) == '{' && text.at(offset - 1) == '$';
    return {Fault{offset - (at_dollar ? 1 : 0), explain(error.msg, text, offset)}, unknown};
  } catch (const std::exception& error) {
    return {Fault{0, std::string("the text cannot be read: ") + error.what()}, false};
  }
  return {};
}

Error syntax_error(const Text& text, const Fault& fault, const std::string& file) {
  return {Errc::syntax, fault.message, place(file, text.position(fault.offset))};
}

}  // namespace

Result<std::string> read_text(const std::string& file) { return read_text_file(file, kMaxBytes); }

std::string place(std::string_view file, Position at) {
  if (at.line == 0) return escaped(file);
  return escaped(file) + ":" + std::to_string(at.line) + ":" + std::to_string(at.column);
}

Position position_in(std::string_view where, std::string_view file) {
  Position at;
  std::istringstream numbers(
      std::string(where.substr(std::min(escaped(file).size() + 1, where.size()))));
  char colon = ':';
  numbers >> at.line >> colon >> at.column;
  return at;
}

void set_source(Node& node, int source) {
  node.at.source = source;
  for (Node& item : node.items) set_source(item, source);
  for (Entry& entry : node.entries) {
    entry.at.source = source;
    set_source(entry.value, source);
  }
}

Result<Document> parse(std::string_view text_bytes, std::string file_name) {
  const Text text(text_bytes);
  if (const auto fault = text.check()) return syntax_error(text, *fault, file_name);

  if (auto root = detail::read_quickly(text.bytes())) {
    return Document{*std::move(root), std::move(file_name), {}};
  }
  std::vector<Problem> problems = text.directive_problems();
  std::string feed = feed_of(text.bytes());
  Document document;
  for (std::size_t unknown = 0;; ++unknown) {
    document = Document{};
    Builder builder(text, document);
    const Ended outcome = run(feed, text, builder);
    if (!outcome.fault) break;
    if (!outcome.unknown_anchor) return syntax_error(text, *outcome.fault, file_name);
    const std::size_t offset = outcome.fault->offset;
    const std::string name = drop_alias(feed, offset);
    problems.push_back({text.position(offset), builder.unknown_anchor(name)});
    if (unknown + 1 == kMaxUnknownAnchors) break;
  }
  document.file = std::move(file_name);
  problems.insert(problems.end(), document.problems.begin(), document.problems.end());
  std::stable_sort(problems.begin(), problems.end(), [](const Problem& a, const Problem& b) {
    return std::pair(a.at.line, a.at.column) < std::pair(b.at.line, b.at.column);
  });
  document.problems = std::move(problems);
  return document;
}

}  // namespace weft::yaml
