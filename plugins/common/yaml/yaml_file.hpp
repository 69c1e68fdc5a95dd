// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <yaml-cpp/yaml.h>

#include <stdexcept>
#include <string>
#include <vector>
#include <weft/core/result.hpp>

/// YAML files that a parameter names.
namespace weft::yaml_files {

/// A mistake in a file; the text begins with its place.
struct FileMistake : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Ends the reading of a file with a mistake at `node`, "file:line:column: message".
[[noreturn]] void fail_at(const std::string& path, const YAML::Node& node,
                          const std::string& message);

/// The text of a regular file of at most 1 MiB; `parameter` is what names it.
Result<std::string> read_yaml_text(const std::string& path, const std::string& parameter);

/// What to say where the library's parser gave up.
Error syntax_error(const std::string& path, const YAML::Mark& mark);

/// Fails at a control character: yaml-cpp takes one of them for the end of the text.
Result<void> check_characters(const std::string& path, const std::string& text);

/// What `read` makes of the root of a YAML text; it reports mistakes with fail_at.
template <class Read>
auto read_yaml(const std::string& path, const std::string& text, Read read)
    -> Result<decltype(read(YAML::Node()))> {
  if (auto checked = check_characters(path, text); !checked) return checked.error();
  try {
    const std::vector<YAML::Node> documents = YAML::LoadAll(text);
    if (documents.size() > 1) {
      fail_at(path, documents[1], "more than one document: put it into a file of its own");
    }
    return read(documents.empty() ? YAML::Node() : documents.front());
  } catch (const FileMistake& mistake) {
    return Error{Errc::invalid_data, mistake.what()};
  } catch (const YAML::Exception& mistake) {
    return syntax_error(path, mistake.mark);
  }
}

}  // namespace weft::yaml_files
