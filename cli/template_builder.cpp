// SPDX-License-Identifier: Apache-2.0
#include "template_builder.hpp"

#include <weft/host/component_spec.hpp>

namespace weft::cli {

Result<host::RecordPtr> build_template(const host::Registry& registry,
                                       const std::string& component) {
  const auto document = yaml::parse(component, "template");
  if (!document) return document.error();
  std::vector<yaml::Problem> problems = document->problems;
  const auto spec =
      host::resolve_component(registry, *document->root.find("use"), document->root.find("params"),
                              host::PathRules::of_process({"."}, "."), problems);
  if (!spec) return Error{Errc::not_found, problems.front().message, {}};
  host::Lane lane(0, {});
  const auto instance = lane.instantiate(*spec, "template");
  if (!instance) return instance.error();
  const host::Outcome outcome = lane.call(**instance, 0, {}, host::kOfflineFrame);
  if (!outcome.usable()) return outcome.error;
  return outcome.find("template");
}

}  // namespace weft::cli
