// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <yaml-cpp/yaml.h>

#include <stdexcept>
#include <string>
#include <weft/core/result.hpp>

/// Files that a parameter of a source names.
namespace weft::sources {

/// A mistake in a file; the text begins with its place.
struct FileMistake : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Ends the reading of a file with a mistake at `node`, "file:line:column: message".
[[noreturn]] void fail_at(const std::string& path, const YAML::Node& node,
                          const std::string& message);

/// The text of a file of at most 1 MiB; `parameter` is what names it.
Result<std::string> read_text_file(const std::string& path, const std::string& parameter);

/// What `read` makes of the root of a YAML text; it reports mistakes with fail_at.
template <class Read>
auto read_yaml(const std::string& path, const std::string& text, Read read)
    -> Result<decltype(read(YAML::Node()))> {
  try {
    return read(YAML::Load(text));
  } catch (const FileMistake& mistake) {
    return Error{Errc::invalid_data, mistake.what(), {}};
  } catch (const YAML::Exception& mistake) {
    return Error{Errc::syntax,
                 path + ":" + std::to_string(mistake.mark.line + 1) + ":" +
                     std::to_string(mistake.mark.column + 1) + ": " + mistake.msg,
                 {}};
  }
}

}  // namespace weft::sources
