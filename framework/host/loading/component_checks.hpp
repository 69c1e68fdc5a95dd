// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "host/loading/component_spec.hpp"

namespace weft::host {

/// Runs the components' own checks of their parameters before anything runs (WEFT_CHECK): files
/// that cannot be read, patterns without a match, values that exclude one another. Only libraries
/// whose manifest has the extension are loaded. Each pair of component and parameters is checked
/// once in the life of this object, so that a plan of many cells reads each file once.
class ComponentChecks {
 public:
  /// `asking` gets the id of each component before its library is loaded and its check is called.
  explicit ComponentChecks(std::function<void(const std::string& id)> asking = {})
      : asking_(std::move(asking)) {}

  /// Appends the errors of the component and of those nested in it, each at the value of its
  /// parameter, or at `use`. Doubtful values are appended to `warnings`, if given.
  void ask(const ComponentSpec& spec, std::vector<yaml::Problem>& problems,
           std::vector<yaml::Problem>* warnings = nullptr);

 private:
  struct Mistake {
    std::string parameter;  ///< empty where it is about none
    std::string message;
  };

  static std::vector<Mistake> mistakes_of(const ComponentSpec& spec);

  std::function<void(const std::string& id)> asking_;
  std::map<std::string, std::vector<Mistake>> known_;  ///< by id and values
};

}  // namespace weft::host
