// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <weft/core/quote.hpp>

#include "host/loading/component_spec.hpp"

namespace weft::host {

PathRules PathRules::of_process(std::vector<std::string> input_folders, std::string output_folder) {
  return {std::move(input_folders), std::move(output_folder),
          [](const std::string& name) -> std::optional<std::string> {
            const char* value = std::getenv(name.c_str());
            return value != nullptr ? std::optional<std::string>(value) : std::nullopt;
          },
          false};
}

namespace {

/// The text with `${NAME}` instead of the shell's `~` or `$NAME` at its beginning.
Result<std::string> with_braces(const std::string& text) {
  const std::size_t end = std::min(text.find('/'), text.size());
  const std::string first = text.substr(0, end), rest = text.substr(end);
  if (first == "~") return "${HOME}" + rest;
  if (first.starts_with('~')) {
    return Error{Errc::invalid_value, quote(text) +
                                          " begins with ~, but only ~/ (your home folder) is "
                                          "expanded; write the whole path, or " +
                                          quote("./" + text) + " for a file of that name"};
  }
  const auto is_letter = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
  };
  const bool is_variable =
      first.size() > 1 && first[0] == '$' && std::all_of(first.begin() + 1, first.end(), is_letter);
  return is_variable ? "${" + first.substr(1) + "}" + rest : text;
}

}  // namespace

Result<std::string> expand_path(const std::string& path, const PathRules& paths) {
  const auto braced = with_braces(path);
  if (!braced) return braced.error();
  return expand_variables(*braced, paths);
}

Result<std::string> expand_variables(const std::string& text, const PathRules& paths) {
  std::string result;
  std::size_t at = 0;
  for (;;) {
    const std::size_t start = text.find("${", at);
    if (start == std::string::npos) return result + text.substr(at);
    const std::size_t end = text.find('}', start);
    if (end == std::string::npos) {
      return Error{Errc::invalid_value, quote(text) + " has ${ without }"};
    }
    const std::string inside = text.substr(start + 2, end - start - 2);
    if (inside.find("${") != std::string::npos) {
      return Error{Errc::invalid_value, quote(text) + " has ${ inside ${...}"};
    }
    const std::size_t dash = inside.find(":-");
    const std::string name = inside.substr(0, dash);
    std::optional<std::string> value = paths.variable(name);
    if ((!value || value->empty()) && dash != std::string::npos) value = inside.substr(dash + 2);
    if (!value) {
      const std::string shown = escaped(name, 80);
      return Error{Errc::not_found, "the variable " + shown + " is not set; set it, or write ${" +
                                        shown + ":-default}"};
    }
    if (value->empty() && dash == std::string::npos) {
      return Error{Errc::not_found,
                   "the variable " + name + " is empty; set it, or write ${" + name + ":-default}"};
    }
    result += text.substr(at, start - at) + *value;
    at = end + 1;
  }
}

std::string default_output(std::string text, const Arguments& given) {
  for (const weft_value& other : given.values()) {
    const std::string name = "{" + std::string(other.name) + "}";
    const std::size_t at = other.type == WEFT_VALUE_OUTPUT_PATH ? text.find(name) : text.npos;
    if (at == text.npos) continue;
    std::filesystem::path path = *static_cast<const char* const*>(other.data);
    text.replace(at, name.size(), path.replace_extension().string());
  }
  return text;
}

std::string path_in_run(const std::string& path, const PathRules& paths) {
  namespace fs = std::filesystem;
  if (paths.output_folder.empty()) return path;
  const fs::path folder = fs::path(paths.output_folder).lexically_normal();
  const fs::path inside = fs::path(path).lexically_relative(folder);
  return inside.empty() || *inside.begin() == ".." ? path : inside.string();
}

}  // namespace weft::host
