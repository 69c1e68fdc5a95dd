// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <yaml-cpp/yaml.h>

#include <optional>
#include <stdexcept>
#include <string>
#include <weft/core/result.hpp>

/// YAML files that a parameter names.
namespace weft::yaml_files {

/// An error in a file and its position, as yaml-cpp counts.
struct FileMistake : std::runtime_error {
  FileMistake(const YAML::Mark& at, const std::string& message)
      : std::runtime_error(message), mark(at) {}
  YAML::Mark mark;
};

/// Stops the reading of a file with an error at `node`.
[[noreturn]] void fail_at(const YAML::Node& node, const std::string& message);

/// The error as an Error, "file:line:column: message"; columns count characters.
Error error_of(const std::string& path, const std::string& text, const FileMistake& mistake);

/// The text of a regular file of at most 1 MiB; `parameter` is what names it.
Result<std::string> read_yaml_text(const std::string& path, const std::string& parameter);

/// The message where the library's parser gave up.
Error syntax_error(const std::string& path, const std::string& text, const YAML::Mark& mark);

/// Fails on text that is not UTF-8, and on control characters, because yaml-cpp takes one of them
/// for the end of the text.
Result<void> check_characters(const std::string& path, const std::string& text);

/// Ends the reading of a text behind its first document. Throws FileMistake or YAML::Exception.
void require_one_document(const std::string& text);

/// Finds a common cause why a text cannot be parsed: a missing blank behind the colon of a key, or
/// a tab that indents. `error` is the error of the parser; nothing where it has another cause.
std::optional<Error> slip_in(const std::string& path, const std::string& text, const Error& error);

/// The result of `read`, which reports errors in a text with FileMistake.
template <class Read>
auto reading(const std::string& path, const std::string& text, Read read)
    -> Result<decltype(read())> {
  if (auto checked = check_characters(path, text); !checked) return checked.error();
  try {
    return read();
  } catch (const FileMistake& mistake) {
    return error_of(path, text, mistake);
  } catch (const YAML::Exception& mistake) {
    return syntax_error(path, text, mistake.mark);
  }
}

/// The result of `read` for the root of a YAML text; `read` reports errors with fail_at.
template <class Read>
auto read_yaml(const std::string& path, const std::string& text, Read read)
    -> Result<decltype(read(YAML::Node()))> {
  return reading(path, text, [&] {
    require_one_document(text);
    return read(YAML::Load(text));
  });
}

}  // namespace weft::yaml_files
