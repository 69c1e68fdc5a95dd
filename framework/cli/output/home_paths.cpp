// SPDX-License-Identifier: Apache-2.0
#include "cli/output/home_paths.hpp"

#include "host/loading/component_spec.hpp"

namespace weft::cli {

Result<std::vector<std::string>> expand_arguments(int argc, const char* const* argv) {
  const auto paths = host::PathRules::of_process({}, {});
  std::vector<std::string> arguments(argv, argv + argc);
  for (std::string& argument : arguments) {
    const std::size_t equals = argument.starts_with("--") ? argument.find('=') : argument.npos;
    const std::size_t start = equals == argument.npos ? 0 : equals + 1;
    if (!argument.substr(start).starts_with('~') && !argument.substr(start).starts_with('$')) {
      continue;
    }
    const auto expanded = host::expand_path(argument.substr(start), paths);
    if (!expanded) return Error{expanded.error().code, expanded.error().message, {}};
    argument.replace(start, argument.npos, *expanded);
  }
  return arguments;
}

}  // namespace weft::cli
