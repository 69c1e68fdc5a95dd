// SPDX-License-Identifier: Apache-2.0
#include "host/loading/component_checks.hpp"

#include <algorithm>
#include <weft/core/index.hpp>
#include <weft/core/mistakes.hpp>
#include <weft/core/quote.hpp>

#include "host/guarding/library_call.hpp"
#include "host/records/plugin_error.hpp"

namespace weft::host {
namespace {

std::size_t element_size(std::int32_t type) {
  if (type == WEFT_VALUE_F64) return sizeof(double);
  return type == WEFT_VALUE_BOOL ? sizeof(std::uint8_t) : sizeof(std::int64_t);
}

bool is_text(std::int32_t type) {
  return type >= WEFT_VALUE_CHOICE && type != WEFT_VALUE_COMPONENT;
}

/// Equal for the same component with the same values, whatever is nested in it.
std::string identity_of(const ComponentSpec& spec) {
  std::string key = spec.component().id;
  for (const weft_value& value : spec.arguments.values()) {
    key += '\0';
    key += value.name;
    key += '\0' + std::to_string(value.count) + ':';
    const auto count = to_index(value.count);
    if (is_text(value.type)) {
      for (std::size_t i = 0; i < count; ++i) {
        key += static_cast<const char* const*>(value.data)[i];
        key += '\0';
      }
    } else {
      key.append(static_cast<const char*>(value.data), count * element_size(value.type));
    }
  }
  return key;
}

/// The position at which an unknown parameter is reported.
yaml::Position place_of(const ComponentSpec& spec) {
  const yaml::Node* use = spec.effective.find("use");
  return use != nullptr ? use->at : spec.effective.at;
}

}  // namespace

std::vector<ComponentChecks::Mistake> ComponentChecks::mistakes_of(const ComponentSpec& spec) {
  const auto failed = [](const Error& error) {
    return std::vector<Mistake>{{"", error.where + ": " + error.message}};
  };
  const auto table = load(*spec.installed);
  if (!table) return failed(table.error());
  const auto found = extension_of<weft_check>(**table, WEFT_CHECK);
  if (!found) return failed(found.error());
  const weft_check* extension = *found;
  if (extension == nullptr) return {};
  const std::string& id = spec.component().id;
  if (extension->check == nullptr) {
    return failed({Errc::plugin_failure, "its check is damaged; rebuild the plugin", id});
  }
  const std::vector<weft_value>& values = spec.arguments.values();
  void* self = nullptr;
  weft_error error = kNoError;
  const weft_create with = made_from(values);
  const ProcessState before;
  std::int32_t status =
      call_library(id.c_str(), error, [&] { return (*table)->create(&with, &self, &error); });
  if (status != WEFT_OK) return failed(plugin_error(status, error, id));
  if (self == nullptr) {
    return failed({Errc::plugin_failure, "created nothing and gave no reason", id});
  }
  std::vector<Mistake> mistakes;
  const auto note = [](void* context, const char* parameter, const char* message) {
    const auto text = [](const char* given) { return given != nullptr ? given : ""; };
    static_cast<std::vector<Mistake>*>(context)->push_back(
        {text(parameter), escaped(text(message))});
  };
  status = call_library(id.c_str(), error,
                        [&] { return extension->check(self, &mistakes, note, &error); });
  weft_error at_end = kNoError;
  const std::int32_t ended = call_library(id.c_str(), at_end, [&] { (*table)->destroy(self); });
  if (const std::string changes = before.restore("in its check"); !changes.empty()) {
    mistakes.push_back({"", Mistakes::kWarning + changes});
  }
  if (ended != WEFT_OK) mistakes.push_back(failed(plugin_error(ended, at_end, id)).front());
  if (status != WEFT_OK) mistakes.push_back(failed(plugin_error(status, error, id)).front());
  return mistakes;
}

void ComponentChecks::ask(const ComponentSpec& spec, std::vector<yaml::Problem>& problems,
                          std::vector<yaml::Problem>* warnings) {
  if (spec.installed == nullptr) return;  // an error that was already reported
  const std::vector<std::string>& extensions = spec.component().extensions;
  const bool asks = std::find(extensions.begin(), extensions.end(), WEFT_CHECK) != extensions.end();
  if (asks && spec.bound) {
    const auto [entry, is_new] = known_.try_emplace(identity_of(spec));
    if (is_new) {
      if (asking_) asking_(spec.component().id);
      entry->second = mistakes_of(spec);
    }
    for (const Mistake& mistake : entry->second) {
      const auto at = place_of(spec, mistake.parameter).value_or(place_of(spec));
      constexpr std::string_view kPrefix = Mistakes::kWarning;
      if (!mistake.message.starts_with(kPrefix)) {
        problems.push_back({at, mistake.message});
      } else if (warnings != nullptr) {
        warnings->push_back({at, mistake.message.substr(kPrefix.size())});
      }
    }
  }
  for (const NestedSpec& nested : spec.nested) ask(nested.component, problems, warnings);
}

}  // namespace weft::host
