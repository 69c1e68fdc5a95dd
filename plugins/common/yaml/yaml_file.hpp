// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <yaml-cpp/yaml.h>

#include <optional>
#include <stdexcept>
#include <string>
#include <weft/core/result.hpp>

/// YAML files that a parameter names.
namespace weft::yaml_files {

/// A mistake in a file and where it is, as yaml-cpp counts.
struct FileMistake : std::runtime_error {
  FileMistake(const YAML::Mark& at, const std::string& message)
      : std::runtime_error(message), mark(at) {}
  YAML::Mark mark;
};

/// Ends the reading of a file with a mistake at `node`.
[[noreturn]] void fail_at(const YAML::Node& node, const std::string& message);

/// The mistake as an Error, "file:line:column: message"; columns count characters.
Error error_of(const std::string& path, const std::string& text, const FileMistake& mistake);

/// The text of a regular file of at most 1 MiB; `parameter` is what names it.
Result<std::string> read_yaml_text(const std::string& path, const std::string& parameter);

/// What to say where the library's parser gave up.
Error syntax_error(const std::string& path, const std::string& text, const YAML::Mark& mark);

/// Fails at a control character, one of which yaml-cpp takes for the end of the text, and at what
/// is no UTF-8.
Result<void> check_characters(const std::string& path, const std::string& text);

/// Ends the reading of a text behind its first document. Throws FileMistake or YAML::Exception.
void require_one_document(const std::string& text);

/// What is wrong where a text cannot be read as it should: a blank that is missing behind the colon
/// of a key, or a tab that indents. `error` is what was found; nothing where it is another mistake.
std::optional<Error> slip_in(const std::string& path, const std::string& text, const Error& error);

/// What `read` returns; it reports mistakes in a text with FileMistake.
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

/// What `read` makes of the root of a YAML text; it reports mistakes with fail_at.
template <class Read>
auto read_yaml(const std::string& path, const std::string& text, Read read)
    -> Result<decltype(read(YAML::Node()))> {
  return reading(path, text, [&] {
    require_one_document(text);
    return read(YAML::Load(text));
  });
}

}  // namespace weft::yaml_files
