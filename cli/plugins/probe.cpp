// SPDX-License-Identifier: Apache-2.0
#include "cli/plugins/probe.hpp"

#include <fmt/core.h>

#include <chrono>
#include <cstdio>
#include <cstring>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/output/outcome.hpp"
#include "cli/run/sudden_end.hpp"
#include "describe/build_id.hpp"
#include "describe/describe.hpp"
#include "host/records/plugin_error.hpp"
#include "programs/program.hpp"

namespace weft::cli {
namespace {

using nlohmann::json;

/// Behind it the answer stands: libraries print too.
constexpr const char* kMark = "\nweft probe: ";
constexpr std::chrono::seconds kLongest{60};  ///< devices are slow to wake

std::string how_it_ended(const Answer& answer) {
  if (answer.late) {
    return fmt::format("it does not come to an end within {} s", kLongest.count());
  }
  if (answer.exit_code > 128) {
    const int signal = answer.exit_code - 128;
    return fmt::format("it ends the process that loads it by signal {} ({})", signal,
                       strsignal(signal));
  }
  return answer.exit_code == kComponentExited
             ? std::string("it ends the process that loads it by exit()")
             : fmt::format("it ends the process that loads it with exit code {}", answer.exit_code);
}

/// What the other process found out of `what`.
Result<json> ask(const std::string& what, const std::string& library, const std::string& id) {
  const auto answer = run_program({"/proc/self/exe", kProbe, what, library, id}, {}, kLongest);
  if (!answer) return answer.error();
  const std::size_t mark = answer->out.rfind(kMark);
  const json said =
      mark == std::string::npos
          ? json(json::value_t::discarded)
          : json::parse(answer->out.substr(mark + std::strlen(kMark)), nullptr, false);
  if (said.is_discarded()) {
    return Error{Errc::incompatible, how_it_ended(*answer) + "; rebuild the plugin", library};
  }
  if (!said.contains("error")) return said.at("answer");
  const json& error = said.at("error");
  return Error{static_cast<Errc>(error.at("code").get<int>()),
               error.at("message").get<std::string>(), error.at("where").get<std::string>()};
}

host::Installed installed(const std::string& library, const std::string& id) {
  auto manifest = std::make_shared<host::Manifest>();
  manifest->library = library;
  host::Installed entry;
  entry.component.id = id;
  entry.library = std::move(manifest);
  return entry;
}

Result<json> manifest_here(const std::string& library) {
  const auto build_id = host::read_build_id(library);
  if (!build_id) return build_id.error();
  if (build_id->empty()) {
    return Error{Errc::incompatible, "has no build-id; link it with -Wl,--build-id=sha1", library};
  }
  const auto table = host::load_library(library);
  if (!table) return table.error();
  const auto text = host::describe_library(**table, *build_id);
  if (!text) return text.error();
  return json(*text);
}

Result<json> devices_here(const weft_component& component) {
  const std::string id = component.id;
  const auto broken = [&](const std::string& reason) {
    return Error{Errc::plugin_failure, reason, id};
  };
  const void* found =
      component.get_extension != nullptr ? component.get_extension(WEFT_DEVICES) : nullptr;
  const auto* extension = static_cast<const weft_devices*>(found);
  if (extension == nullptr || extension->struct_size < sizeof(weft_devices) ||
      extension->list == nullptr) {
    return broken("its list of devices is damaged; rebuild the plugin");
  }
  std::vector<std::string> devices;
  weft_error error = kNoError;
  const auto add = [](void* context, const char* text) {
    if (text != nullptr) static_cast<std::vector<std::string>*>(context)->emplace_back(text);
  };
  const std::int32_t status = extension->list(&devices, add, &error);
  if (status == WEFT_OK) return json(devices);
  return broken(host::plugin_error(status, error, id).message);
}

Result<json> find_out(const std::string& what, const std::string& library, const std::string& id) {
  if (what == "manifest") return manifest_here(library);
  const auto component = host::load(installed(library, id));
  if (!component) return component.error();
  return what == "devices" ? devices_here(**component) : Result<json>(json());
}

}  // namespace

Result<void> probe_component(const host::Installed& entry) {
  const auto answer = ask("component", entry.library->library, entry.component.id);
  if (!answer) return answer.error();
  return {};
}

Result<std::string> probe_manifest(const std::string& library) {
  const auto answer = ask("manifest", library, "");
  if (!answer) return answer.error();
  return answer->get<std::string>();
}

Result<std::vector<std::string>> probe_devices(const host::Installed& entry) {
  const auto answer = ask("devices", entry.library->library, entry.component.id);
  if (!answer) return answer.error();
  return answer->get<std::vector<std::string>>();
}

void answer_probe(const std::vector<std::string>& arguments) {
  if (arguments.size() != 4) end_at_once(kBadConfiguration);
  json said;
  if (const auto answer = find_out(arguments[1], arguments[2], arguments[3])) {
    said["answer"] = *answer;
  } else {
    const Error& error = answer.error();
    said["error"] = {
        {"code", static_cast<int>(error.code)}, {"message", error.message}, {"where", error.where}};
  }
  const std::string text = kMark + said.dump(-1, ' ', false, json::error_handler_t::replace) + "\n";
  std::fputs(text.c_str(), stdout);
  std::fflush(stdout);
  end_at_once(kDone);  // whatever libraries do at the end is theirs
}

}  // namespace weft::cli
