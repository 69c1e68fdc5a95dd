// SPDX-License-Identifier: Apache-2.0
#include <stdexcept>
#include <weft/testing/mistakes.hpp>

#include "host/loading/component_checks.hpp"

namespace weft::testing {

std::vector<std::string> mistakes_of(const std::string& id, const std::string& params) {
  const host::Registry registry = host::Registry::scan(host::search_path({}));
  const auto document = yaml::parse("use: " + id + "\nparams: " + params + "\n", "params");
  if (!document) throw std::runtime_error(document.error().message);
  std::vector<yaml::Problem> problems;
  const yaml::Node& given = *document->root.find("params");
  const auto spec = host::resolve_component(registry, *document->root.find("use"), &given,
                                            host::PathRules::of_process({"/"}, "/tmp"), problems);
  if (!spec) throw std::runtime_error(problems.front().message);
  host::ComponentChecks().ask(*spec, problems);
  std::vector<std::string> mistakes;
  for (const yaml::Problem& problem : problems) {
    std::string name;
    for (const yaml::Entry& entry : given.entries) {
      if (entry.value.at == problem.at) name = entry.key;
    }
    mistakes.push_back(name + ": " + problem.message);
  }
  return mistakes;
}

}  // namespace weft::testing
