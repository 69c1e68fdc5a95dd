// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>
#include <fmt/format.h>
#include <sys/utsname.h>

#include <algorithm>
#include <filesystem>
#include <weft/core/version.hpp>

#include "cli/commands.hpp"
#include "cli/output/json_text.hpp"
#include "cli/plugins/machine.hpp"
#include "cli/plugins/plugin_devices.hpp"
#include "host/loading/processor.hpp"
#include "host/probing/probe.hpp"
#include "host/records/shared_memory.hpp"
#include "pipeline/runs/source_revision.hpp"

namespace weft::cli {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

/// Components of pipelines/demo.yaml, the pipeline that a new user runs first.
constexpr const char* kDemoPlugins[] = {
    "sources/synthetic",    "templates/rectangular", "detectors/sift_fast",
    "matchers/descriptor",  "filters/aem",           "warps/bbs",
    "passes/salient_cells", "solvers/gauss_newton",  "solvers/brunet_mdh",
    "matchers/dense_flow",  "matchers/merge",        "passes/self_occlusion",
    "sinks/overlay",        "sinks/meshes"};

ordered_json folders_json(const host::Registry& registry) {
  ordered_json folders = ordered_json::array();
  for (const host::SearchFolder& folder : registry.folders()) {
    const auto is_in_folder = [&](const std::string& file) {
      return file == folder.path || fs::path(file).parent_path() == folder.path;
    };
    const auto usable =
        std::count_if(registry.installed().begin(), registry.installed().end(),
                      [&](const host::Installed& entry) {
                        return !entry.shadowed && is_in_folder(entry.library->library);
                      });
    const auto refused =
        std::count_if(registry.refusals().begin(), registry.refusals().end(),
                      [&](const host::Refusal& refusal) { return is_in_folder(refusal.file); });
    folders.push_back({{"path", folder.path},
                       {"origin", folder.origin},
                       {"usable", usable},
                       {"refused", refused}});
  }
  return folders;
}

ordered_json refused_json(const host::Registry& registry) {
  ordered_json refused = ordered_json::array();
  for (const host::Refusal& refusal : registry.refusals()) {
    refused.push_back({{"file", refusal.file}, {"cause", refusal.cause}, {"fix", refusal.fix}});
  }
  return refused;
}

/// Each plugin of the demo is loaded: a manifest does not know which libraries are missing.
ordered_json demo_json(const host::Registry& registry) {
  ordered_json plugins = ordered_json::array();
  for (const char* id : kDemoPlugins) {
    std::string reason;
    const host::Installed* entry = registry.find(id);
    if (entry == nullptr) {
      reason = registry.explain_missing(id);
    } else if (const auto loaded =
                   host::probe_component(entry->library->library, entry->component.id);
               !loaded) {
      reason = loaded.error().where + ": " + loaded.error().message;
    }
    plugins.push_back({{"id", id}, {"usable", reason.empty()}, {"reason", reason}});
  }
  return plugins;
}

/// Requirements of `isolate: process`; the reason is empty if they are met.
ordered_json isolation_json() {
  std::error_code code;
  const fs::path worker = fs::read_symlink("/proc/self/exe", code).parent_path() / "weft-worker";
  std::string reason;
  if (!fs::exists(worker, code)) {
    reason = worker.string() + " is missing; install it beside weft";
  } else if (const auto memory = host::SharedMemory::create(host::SharedMemory::Access::read);
             !memory) {
    reason = "shared memory " + memory.error().message;
  }
  return {{"usable", reason.empty()}, {"reason", reason}};
}

ordered_json devices_json(const host::Registry& registry) {
  ordered_json found = ordered_json::array();
  for (const Camera& camera : cameras()) {
    found.push_back(
        {{"device", camera.device}, {"name", camera.name}, {"accessible", camera.accessible}});
  }
  return {{"cameras", found},
          {"opencl_drivers", opencl_drivers()},
          {"nvidia", nvidia_devices()},
          {"of_plugins", plugin_devices(registry)}};
}

ordered_json examine(const host::Registry& registry) {
  utsname system{};
  uname(&system);
  const TemporaryFolder temporary = temporary_folder();
  const auto& installed = registry.installed();
  const auto usable = std::count_if(installed.begin(), installed.end(),
                                    [](const host::Installed& entry) { return !entry.shadowed; });
  ordered_json report{
      {"usable", true},
      {"weft", kVersion},
      {"git", host::source_revision()},
      {"abi", host::abi_version()},
      {"system", fmt::format("{} {}", system.sysname, system.release)},
      {"libraries", loaded_libraries()},
      {"processor", {{"name", host::processor_name()}, {"features", host::processor_features()}}},
      {"memory_available_bytes", available_memory_bytes()},
      {"temporary",
       {{"path", temporary.path},
        {"writable", temporary.writable},
        {"free_bytes", temporary.free_bytes}}},
      {"isolation", isolation_json()},
      {"devices", devices_json(registry)},
      {"folders", folders_json(registry)},
      {"plugins", {{"usable", usable}, {"refused", refused_json(registry)}}},
      {"demo", demo_json(registry)}};
  for (const ordered_json& plugin : report["demo"]) {
    if (!plugin["usable"]) report["usable"] = false;
  }
  return report;
}

std::string text(const ordered_json& value) { return value.get<std::string>(); }

std::string joined(const ordered_json& list) {
  const auto items = list.get<std::vector<std::string>>();
  return items.empty() ? "none" : fmt::format("{}", fmt::join(items, ", "));
}

void line(const char* name, const std::string& value) { fmt::print("{:<12}{}\n", name, value); }

std::string gibibytes(const ordered_json& bytes) {
  return fmt::format("{:.1f} GiB", bytes.get<double>() / (1024.0 * 1024.0 * 1024.0));
}

void print_devices(const ordered_json& devices) {
  if (devices["cameras"].empty()) line("cameras", "none");
  for (const ordered_json& camera : devices["cameras"]) {
    line("camera", fmt::format("{} {}{}", text(camera["device"]), text(camera["name"]),
                               camera["accessible"].get<bool>()
                                   ? ""
                                   : "; not accessible: add yourself to the group video"));
  }
  line("OpenCL", joined(devices["opencl_drivers"]));
  line("NVIDIA", joined(devices["nvidia"]));
  for (const ordered_json& entry : devices["of_plugins"]) {
    const auto names = entry["devices"].get<std::vector<std::string>>();
    const std::string plugins = "for " + joined(entry["plugins"]);
    if (names.empty()) {
      const std::string reason = text(entry["reason"]);
      line("device", "none " + plugins + (reason.empty() ? "" : ": " + reason));
    }
    for (std::size_t i = 0; i < names.size(); ++i) {
      line("device", fmt::format("{}: {} {}", i, names[i], plugins));
    }
  }
}

void print_machine(const ordered_json& report) {
  line("weft", fmt::format("{}, plugin ABI {}", text(report["weft"]), text(report["abi"])));
  std::vector<std::string> names;
  for (const ordered_json& file : report["libraries"]) {
    names.push_back(fs::path(text(file)).filename().string());
  }
  line("libraries", fmt::format("{}", fmt::join(names, ", ")));
  line("system", text(report["system"]));
  const ordered_json& processor = report["processor"];
  line("processor", fmt::format("{} ({})", text(processor["name"]), joined(processor["features"])));
  line("memory", gibibytes(report["memory_available_bytes"]) + " available");
  const ordered_json& temporary = report["temporary"];
  line("temporary", fmt::format("{}, {}", text(temporary["path"]),
                                temporary["writable"].get<bool>()
                                    ? gibibytes(temporary["free_bytes"]) + " free"
                                    : "not writable; set TMPDIR to a folder that is"));
  const ordered_json& isolation = report["isolation"];
  line("isolation", isolation["usable"].get<bool>() ? "works" : text(isolation["reason"]));
  print_devices(report["devices"]);
}

void print_plugins(const ordered_json& report) {
  fmt::print("\n");
  for (const ordered_json& folder : report["folders"]) {
    line("searched",
         fmt::format("{} ({}): {} usable, {} refused", text(folder["path"]), text(folder["origin"]),
                     folder["usable"].get<int>(), folder["refused"].get<int>()));
  }
  for (const ordered_json& refusal : report["plugins"]["refused"]) {
    line("refused", fmt::format("{}\n    {};\n    {}", text(refusal["file"]),
                                text(refusal["cause"]), text(refusal["fix"])));
  }
  for (const ordered_json& plugin : report["demo"]) {
    if (!plugin["usable"]) line("unusable", text(plugin["reason"]));
  }
  fmt::print("\nthe demo pipeline {}\n", report["usable"].get<bool>() ? "can run" : "cannot run");
}

}  // namespace

void add_doctor_command(CLI::App& app, Context& context) {
  const auto json = std::make_shared<bool>(false);
  CLI::App* command = app.add_subcommand(
      "doctor", "What is installed, which plugins load, which devices are there");
  command->footer(
      "Exit codes:\n"
      "  0  the plugins of the demo pipeline are usable\n"
      "  1  some are not");
  command->add_flag("--json", *json,
                    "Print JSON: {usable, weft, git, abi, system, libraries, processor: {name, "
                    "features}, memory_available_bytes, temporary: {path, writable, free_bytes}, "
                    "isolation: {usable, reason}, devices: {cameras: [{device, name, "
                    "accessible}], opencl_drivers, nvidia, of_plugins: [{plugins, devices, "
                    "reason}]}, folders: [{path, origin, usable, "
                    "refused}], plugins: {usable, refused: [{file, cause, fix}]}, demo: [{id, "
                    "usable, reason}]}");
  command->callback([&context, json] {
    const ordered_json report = examine(context.registry());
    if (*json) {
      print_json(report);
    } else {
      print_machine(report);
      print_plugins(report);
    }
    context.exit_code = report["usable"].get<bool>() ? kDone : kNotUsable;
  });
}

}  // namespace weft::cli
