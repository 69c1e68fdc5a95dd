// SPDX-License-Identifier: Apache-2.0
#include "host/probing/probe.hpp"

#include <chrono>
#include <functional>
#include <memory>

#include "host/describe/build_id.hpp"
#include "host/describe/describe.hpp"
#include "host/guarding/library_call.hpp"
#include "host/loading/registry.hpp"
#include "host/probing/child.hpp"
#include "host/records/plugin_error.hpp"

namespace weft::host {
namespace {

constexpr std::chrono::seconds kLongest{20};
constexpr std::chrono::seconds kLongestOfDevices{60};  ///< they are slow to wake

Result<std::string> ask(const std::string& library,
                        const std::function<Result<std::string>()>& find_out,
                        std::chrono::seconds longest = kLongest) {
  auto answer = ask_in_child(find_out, longest);
  if (answer || !answer.error().where.empty()) return answer;
  return Error{answer.error().code,
               "it " + answer.error().message +
                   "; correct what it does when it is loaded and when its components are "
                   "constructed, and rebuild it",
               library};
}

Installed installed(const std::string& library, const std::string& id) {
  auto manifest = std::make_shared<Manifest>();
  manifest->library = library;
  Installed entry;
  entry.component.id = id;
  entry.library = std::move(manifest);
  return entry;
}

Result<std::string> manifest_here(const std::string& library, std::string_view first) {
  const auto build_id = read_build_id(library);
  if (!build_id) return build_id.error();
  if (build_id->empty()) {
    return Error{Errc::incompatible, "has no build-id; link it with -Wl,--build-id=sha1", library};
  }
  const auto table = load_library(library);
  if (!table) return table.error();
  if (const std::string_view id = (*table)->components[0]->id; !first.empty() && id != first) {
    return Error{Errc::invalid_value,
                 "its first component is '" + std::string(id) +
                     "', and weft_add_plugin() builds '" + std::string(first) +
                     "': give both the same id",
                 library};
  }
  return describe_library(**table, *build_id);
}

/// One behind the other, each with a NUL at its end.
Result<std::string> devices_here(const std::string& library, const std::string& id) {
  const auto component = load(installed(library, id));
  if (!component) return component.error();
  const auto extension = extension_of<weft_devices>(**component, WEFT_DEVICES);
  if (!extension) return extension.error();
  if (*extension == nullptr || (*extension)->list == nullptr) {
    return Error{Errc::plugin_failure, "its list of devices is damaged; rebuild the plugin", id};
  }
  std::string devices;
  weft_error error{sizeof(weft_error), 0, {}, {}, {}};
  const auto add = [](void* context, const char* text) {
    if (text != nullptr) *static_cast<std::string*>(context) += std::string(text) + '\0';
  };
  const std::int32_t status =
      call_library(id.c_str(), error, [&] { return (*extension)->list(&devices, add, &error); });
  if (status == WEFT_OK) return devices;
  return Error{Errc::plugin_failure, plugin_error(status, error, id).message, id};
}

}  // namespace

Result<void> probe_component(const std::string& library, const std::string& id) {
  const auto answer = ask(library, [&]() -> Result<std::string> {
    const auto component = load(installed(library, id));
    if (!component) return component.error();
    return std::string();
  });
  if (!answer) return answer.error();
  return {};
}

Result<std::string> probe_manifest(const std::string& library, std::string_view first) {
  return ask(library, [&] { return manifest_here(library, first); });
}

Result<std::vector<std::string>> probe_devices(const std::string& library, const std::string& id) {
  const auto answer = ask(
      library, [&] { return devices_here(library, id); }, kLongestOfDevices);
  if (!answer) return answer.error();
  std::vector<std::string> devices;
  for (std::size_t start = 0; start < answer->size(); start += devices.back().size() + 1) {
    devices.emplace_back(answer->c_str() + start);
  }
  return devices;
}

}  // namespace weft::host
