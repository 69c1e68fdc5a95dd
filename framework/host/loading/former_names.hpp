// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "host/loading/registry.hpp"
#include "yaml/yaml.hpp"

namespace weft::host {

/// A deprecated name that a text uses.
struct FormerName {
  yaml::Position at;
  std::string before,
      after;           ///< `after` is empty for a deprecated parameter that has no other name
  std::string what;    ///< "parameter of solvers/gauss_newton", "component", "metric"
  std::string help{};  ///< advice where `after` is empty

  /// "'start' (parameter of solvers/gauss_newton) is deprecated: use 'initial_guess'"
  std::string message() const;
};

/// The present id of a component that was renamed; any other id as it is.
std::string_view current_id(std::string_view id);

/// The present name of a parameter of the component `id`; any other name as it is.
std::string current_parameter(const Registry& registry, std::string_view id,
                              const std::string& name);

/// Replaces former names in `over`: a component {use, params}, or some of its keys, which are
/// merged over `base`. `base` may be null; its names are current. The component is `default_id`
/// where neither has `use`. Two names of one parameter in one map are a problem.
void use_current_names(yaml::Node& over, const yaml::Node* base, const std::string& default_id,
                       const Registry& registry, std::vector<FormerName>& found,
                       std::vector<yaml::Problem>& problems);

}  // namespace weft::host
