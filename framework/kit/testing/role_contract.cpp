// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <regex>
#include <stdexcept>

#include "host/guarding/library_call.hpp"
#include "host/records/plugin_error.hpp"
#include "kit/testing/contract_stages.hpp"
#include "kit/testing/geometry/check_geometry.hpp"

namespace weft::testing {

std::string lacks_device(const Subject& subject) {
  const std::vector<std::string>& extensions = subject.manifest().extensions;
  if (std::find(extensions.begin(), extensions.end(), WEFT_DEVICES) == extensions.end()) return "";
  const auto table = host::load(*subject.spec().installed);
  if (!table) return "";
  const auto found = host::extension_of<weft_devices>(**table, WEFT_DEVICES);
  if (!found || *found == nullptr || (*found)->list == nullptr) return "";
  const weft_devices* list = *found;
  int devices = 0;
  const auto count = [](void* context, const char*) { ++*static_cast<int*>(context); };
  weft_error error = kNoError;
  const std::int32_t status = list->list(&devices, count, &error);
  if (status == WEFT_OK && devices > 0) return "";
  const std::string why = host::plugin_error(status, error, subject.manifest().id).message;
  return "there is no device" + (why.empty() ? "" : ": " + why);
}

namespace {

void check_manifest(const Subject& subject, Checks& checks) {
  checks.begin("its manifest");
  const host::ComponentManifest& manifest = subject.manifest();
  const std::regex form("[a-z][a-z0-9_]*/([a-z][a-z0-9_]*\\.)?[a-z][a-z0-9_]*");
  checks.expect(std::regex_match(manifest.id, form), "'" + manifest.id + "' is no id");
  checks.expect(!manifest.summary.empty() && !manifest.version.empty(),
                "it has no summary or no version");
  const auto& outputs = subject.rules().main_method().outputs;
  const bool makes_any =
      outputs.empty() || std::any_of(outputs.begin(), outputs.end(), [&](const RoleSlot& output) {
        return subject.produces(output.name);
      });
  checks.expect(makes_any, "it announces no output: list its outputs in kAbout, as 'produces'");
}

void check_life(const Subject& subject, Checks& checks) {
  const Scene scene = make_scene(0, subject.seed);
  for (const char* what : {"created and prepared", "created again"}) {
    checks.begin(what);
    Performer performer(subject);
    const auto ready = performer.begin(scene.templ, scene.camera);
    if (!ready) checks.fail(ready.error().message);
  }
}

}  // namespace

void check_component(const FindIn& find, Checks& checks) {
  checks.begin("its parameters");
  const ScratchFolder folder;
  const auto subject = find(folder.path().string());
  if (!subject) return checks.fail(subject.error().message);
  const std::string lack = lacks_device(*subject);
  if (!lack.empty()) return checks.skip(lack);
  check_manifest(*subject, checks);
  check_life(*subject, checks);
  if (!checks.report().failures.empty()) return;
  const RoleRules& rules = subject->rules();
  if (rules.part == PipelinePart::source) return check_source(*subject, checks);
  if (rules.part == PipelinePart::templ) return check_template(*subject, checks);
  if (rules.part == PipelinePart::sink) return check_sink(find, checks);
  check_stage(*subject, checks);
  if (rules.samples) check_warp(*subject, checks);
}

ContractReport check_role_contract(const std::string& id, const ContractOptions& options) {
  const host::Registry registry = host::Registry::scan(host::search_path(options.plugin_folders));
  const FindIn find = [&](const std::string& output_folder) {
    return Subject::find(registry, id, options.params, output_folder);
  };
  Checks checks(options);
  check_component(find, checks);
  const ScratchFolder folder;
  const auto subject = find(folder.path().string());
  if (options.geometry && subject && checks.report().skipped.empty()) {
    check_geometry(*subject, checks);
  }
  ContractReport report = checks.report();
  for (const std::string& known : options.deviations) {
    const bool occurs =
        std::any_of(report.deviations.begin(), report.deviations.end(),
                    [&](const std::string& line) { return line.starts_with(known + ": "); });
    if (!occurs) report.failures.push_back(known + ": is declared as a deviation, and passes");
  }
  return report;
}

std::vector<std::string> components_in(const std::string& manifest_file) {
  const auto manifest = host::read_manifest(manifest_file);
  if (!manifest) throw std::runtime_error(manifest.error().where + ": " + manifest.error().message);
  std::vector<std::string> ids;
  for (const host::ComponentManifest& component : manifest->components) ids.push_back(component.id);
  return ids;
}

}  // namespace weft::testing
