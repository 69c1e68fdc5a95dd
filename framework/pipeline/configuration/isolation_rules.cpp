// SPDX-License-Identifier: Apache-2.0
#include "pipeline/configuration/isolation_rules.hpp"

#include <algorithm>
#include <weft/core/quote.hpp>

namespace weft {
namespace {

/// True if its library, or that of a nested component, did not come with the program.
bool is_foreign(const host::ComponentSpec& spec) {
  return spec.installed != nullptr &&
         (!spec.installed->is_own ||
          std::any_of(spec.nested.begin(), spec.nested.end(),
                      [](const host::NestedSpec& nested) { return is_foreign(nested.component); }));
}

/// Records that it leaves on a device would have to be fetched for the others.
bool keeps_device(const host::ComponentSpec& spec) {
  return spec.installed != nullptr &&
         (spec.component().keeps_arrays_on_devices() ||
          std::any_of(spec.nested.begin(), spec.nested.end(), [](const host::NestedSpec& nested) {
            return keeps_device(nested.component);
          }));
}

/// A parameter that names what only this process has open, in words, or empty.
std::string path_bound_here(const host::ComponentSpec& spec) {
  const yaml::Node* params = spec.effective.find("params");
  for (const host::ParameterSpec& parameter : spec.component().parameters) {
    const bool is_path =
        parameter.type == WEFT_VALUE_INPUT_PATH || parameter.type == WEFT_VALUE_OUTPUT_PATH;
    const yaml::Node* value = params != nullptr ? params->find(parameter.name) : nullptr;
    if (!is_path || value == nullptr) continue;
    for (const char* open : {"/dev/std", "/dev/fd/", "/proc/self/"}) {
      if (!value->scalar.starts_with(open)) continue;
      return quote(parameter.name) + " is " + quote(value->scalar) +
             ", which only this process has";
    }
  }
  return {};
}

}  // namespace

IsolationRules::IsolationRules(const host::ComponentSpec& component, PipelinePart part,
                               Isolating isolating) {
  if (component.installed == nullptr) return;
  const bool prefers = part == PipelinePart::stage && component.component().prefers_isolation();
  const bool foreign = is_foreign(component);
  switch (isolating) {
    case Isolating::preferred:
      is_wanted_ = prefers;
      break;
    case Isolating::automatic:
      is_wanted_ = prefers || (foreign && !keeps_device(component));
      break;
    case Isolating::none:
      break;
    case Isolating::all:
      is_wanted_ = true;
      break;
  }
  has_reason_ = prefers || (foreign && isolating != Isolating::preferred);
  bound_by_ = component.component().steers_runs() ? "the run is steered through this sink"
                                                  : path_bound_here(component);
}

}  // namespace weft
