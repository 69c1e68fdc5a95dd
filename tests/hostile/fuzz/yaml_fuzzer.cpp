// SPDX-License-Identifier: Apache-2.0
// The strict reader: places are inside the text, and printed text is read again as the same.
#include "fuzzing.hpp"
#include "yaml/yaml.hpp"

namespace {

using namespace weft;
using fuzzing::require;

constexpr const char* kFile = "input.yaml";

void check_places(const yaml::Node& node, const fuzzing::Lines& lines) {
  lines.require_inside(node.at.line, node.at.column);
  for (const yaml::Node& item : node.items) check_places(item, lines);
  for (const yaml::Entry& entry : node.entries) {
    lines.require_inside(entry.at.line, entry.at.column);
    check_places(entry.value, lines);
  }
}

/// A scalar must have one type only.
void check_types(const yaml::Node& node) {
  if (yaml::as_int64(node))
    require(yaml::as_double(node).has_value(), "a whole number is a number");
  const int types = int{yaml::is_null(node)} + int{yaml::as_bool(node).has_value()} +
                    int{yaml::as_double(node).has_value()};
  require(types <= 1, "a value of one type", node.scalar);
  require(!node.quoted || types == 0, "a quoted value is text", node.scalar);
  for (const yaml::Node& item : node.items) check_types(item);
  for (const yaml::Entry& entry : node.entries) check_types(entry.value);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string_view text = fuzzing::text_of(data, size);
  const auto document = yaml::parse(text, kFile);
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);  // not counted in columns
  if (!document) {
    require(document.error().code == Errc::syntax, "a syntax error");
    require(!document.error().message.empty(), "a message");
    const auto rest = fuzzing::require_place(document.error().where, kFile, text);
    require(rest.empty(), "a place alone", document.error().where);
    return 0;
  }
  const fuzzing::Lines lines(text);
  yaml::Position last;
  for (const yaml::Problem& problem : document->problems) {
    require(!problem.message.empty(), "a message");
    lines.require_inside(problem.at.line, problem.at.column);
    require(std::pair(last.line, last.column) <= std::pair(problem.at.line, problem.at.column),
            "problems in the order of the text");
    last = problem.at;
  }
  check_places(document->root, lines);
  if (!document->problems.empty()) return 0;
  check_types(document->root);
  const std::string printed = yaml::emit(document->root);
  const auto again = yaml::parse(printed, kFile);
  require(static_cast<bool>(again), "what is printed can be read", printed);
  require(again->problems.empty(), "what is printed has no mistake", printed);
  require(again->root == document->root, "what is printed means the same", printed);
  require(yaml::emit(again->root) == printed, "what is read again is printed alike", printed);
  return 0;
}
