// SPDX-License-Identifier: Apache-2.0
#include "kit/testing/contract_subject.hpp"

#include <stdlib.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <weft/core/index.hpp>

#include "host/calling/execution_context_parts.hpp"
#include "host/calling/protected_inputs.hpp"
#include "host/guarding/library_call.hpp"
#include "host/loading/component_checks.hpp"
#include "host/records/plugin_error.hpp"

namespace weft::testing {
namespace {

/// The stage by which all instances draw, so that their draws are the same.
constexpr const char* kStage = "contract";

bool has(const std::vector<std::string>& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

Answer answer_of(host::Outcome outcome) {
  Answer answer{outcome.status, outcome.error.code, std::move(outcome.error.message), {}};
  for (auto& [slot, record] : outcome.outputs) {
    answer.outputs.emplace_back(slot, fetched(record, record->type()));
  }
  return answer;
}

std::string difference(const weft_array& a, const weft_array& b) {
  if (a.dtype != b.dtype || a.ndim != b.ndim || !std::equal(a.shape, a.shape + a.ndim, b.shape)) {
    return "has another length or type";
  }
  const auto bytes = to_index(host::array_bytes(a.dtype, a.ndim, a.shape));
  return bytes == 0 || std::memcmp(a.data, b.data, bytes) == 0 ? "" : "differs";
}

std::string difference(const std::string& slot, const weft_record& a, const weft_record& b) {
  if (a.count != b.count) return slot + " has other arrays";
  for (std::uint64_t i = 0; i < a.count; ++i) {
    if (std::string_view(a.arrays[i].name) != b.arrays[i].name) return slot + " has other arrays";
    const std::string how = difference(a.arrays[i], b.arrays[i]);
    if (!how.empty()) return slot + "/" + a.arrays[i].name + " " + how;
  }
  return "";
}

bool draws(const host::ComponentSpec& spec) {
  return spec.component().random ||
         std::any_of(spec.nested.begin(), spec.nested.end(),
                     [](const host::NestedSpec& nested) { return draws(nested.component); });
}

std::optional<host::ComponentSpec> any_warp(const host::Registry& registry) {
  for (const host::Installed& entry : registry.installed()) {
    if (entry.shadowed || !rules_of(entry.component.role()).samples) continue;
    const auto document = yaml::parse("use: " + entry.component.id + "\n", "warp");
    std::vector<yaml::Problem> problems;
    auto spec = host::resolve_component(registry, *document->root.find("use"), nullptr,
                                        host::PathRules::of_process({"/"}, "/"), problems);
    if (spec) return spec;
  }
  return std::nullopt;
}

}  // namespace

ScratchFolder::ScratchFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "weft_contract_XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) throw std::runtime_error(name + ": cannot be made");
  path_ = name;
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

Result<Subject> Subject::find(const host::Registry& registry, const std::string& id,
                              const std::string& params, const std::string& output_folder) {
  const auto document = yaml::parse("use: " + id + "\nparams: " + params + "\n", "params");
  if (!document) return document.error();
  if (document->problems.empty()) {
    return find(registry, id, *document->root.find("params"), output_folder);
  }
  return Error{Errc::syntax, document->problems.front().message, id};
}

Result<Subject> Subject::find(const host::Registry& registry, const std::string& id,
                              const yaml::Node& params, const std::string& output_folder) {
  std::vector<yaml::Problem> problems;
  const std::string here = std::filesystem::current_path().string();
  std::optional<host::ComponentSpec> spec =
      host::resolve_component(registry, yaml::text_node(id), &params,
                              host::PathRules::of_process({here}, output_folder), problems);
  if (spec && problems.empty()) host::ComponentChecks().ask(*spec, problems);
  if (spec && problems.empty()) {
    Subject subject(registry, *std::move(spec));
    if (subject.takes("warp")) subject.warp_maker = any_warp(registry);
    return subject;
  }
  std::string all;
  for (const yaml::Problem& problem : problems) all += problem.message + "; ";
  return Error{Errc::invalid_value,
               all +
                   "give parameters as CONTRACT \"{name: value}\" of weft_add_plugin, or by "
                   "weft plugins check " +
                   id + " --params \"{name: value}\"",
               id};
}

bool Subject::is_random() const { return draws(spec_); }

bool Subject::takes(std::string_view slot) const {
  return requires_input(slot) || has(manifest().reads, slot);
}

bool Subject::requires_input(std::string_view slot) const {
  for (const RoleSlot& input : rules().main_method().inputs) {
    if (input.name == slot && input.required) return true;
  }
  return has(manifest().needs, slot);
}

bool Subject::produces(std::string_view output) const {
  for (const RoleSlot& made : rules().main_method().outputs) {
    if (made.name == output && made.required) return true;
  }
  return has(manifest().produces, output);
}

HostRecord Answer::find(std::string_view slot) const {
  for (const auto& [name, record] : outputs) {
    if (name == slot) return record;
  }
  return nullptr;
}

std::string to_text(const Answer& answer) {
  constexpr const char* kNames[] = {"ok", "degenerate", "no_result", "error", "cancelled", "end"};
  const std::string name = kNames[to_index(static_cast<std::int32_t>(answer.status))];
  return answer.message.empty() ? name : name + " (" + answer.message + ")";
}

std::string difference(const Answer& a, const Answer& b) {
  if (a.status != b.status) return "it reports " + to_text(a) + ", not " + to_text(b);
  if (a.outputs.size() != b.outputs.size()) return "it makes other outputs";
  for (const auto& [slot, record] : a.outputs) {
    const HostRecord other = b.find(slot);
    if (other == nullptr || record == nullptr) return "it makes other outputs";
    std::string how = difference(slot, view_of(record), view_of(other));
    if (!how.empty()) return how;
  }
  return "";
}

SpoiltInput spoilt_input_at(const void* address) {
  const host::ProtectedPlace place = host::protected_place(address);
  if (place.input == nullptr) return {nullptr, nullptr};
  return {place.beyond ? "went beyond the end of its input " : "wrote into its input ",
          place.input};
}

std::int32_t Passage::create(const weft_component& component, const weft_create& with, void** self,
                             weft_error* error) {
  return component.create(&with, self, error);
}

std::int32_t Passage::prepare(const weft_component& component, void* self, const weft_call& call,
                              std::span<const weft_record> inputs, weft_error* error) {
  return component.prepare(self, &call, inputs.data(), inputs.size(), error);
}

std::int32_t Passage::process(const weft_component& component, void* self, const weft_call& call,
                              std::span<const weft_record> inputs, weft_error* error) {
  return component.process(self, &call, inputs.data(), inputs.size(), error);
}

void Passage::destroy(const weft_component& component, void* self) { component.destroy(self); }

/// Replaces an instance whose calls take a passage.
struct Performer::Passed {
  Passage& passage;
  const weft_component& component;
  void* self;
  weft_component table;

  static Passed& of(void* self) { return *static_cast<Passed*>(self); }
  static std::int32_t prepare(void* self, const weft_call* call, const weft_record* inputs,
                              std::uint64_t count, weft_error* error) {
    const Passed& to = of(self);
    return to.passage.prepare(to.component, to.self, *call, {inputs, count}, error);
  }
  static std::int32_t process(void* self, const weft_call* call, const weft_record* inputs,
                              std::uint64_t count, weft_error* error) {
    const Passed& to = of(self);
    return to.passage.process(to.component, to.self, *call, {inputs, count}, error);
  }
  static void destroy(void* self) { of(self).passage.destroy(of(self).component, of(self).self); }
};

Performer::Performer(const Subject& subject, const Performance& how)
    : subject_(&subject), how_(how), context_(how.run_seed, {}, how.arena) {
  if (how.protects_inputs) context_.protect_inputs();
  context_.divide_threads(how.threads, 1);
}

Performer::~Performer() = default;

/// Creates an instance in the execution context. Its calls go through the passage, if there is one.
Result<host::Instance*> Performer::made(const Subject& subject) {
  if (how_.arena != nullptr) return context_.instantiate_isolated(subject.spec(), kStage, {});
  auto made = context_.instantiate(subject.spec(), kStage);
  if (!made || how_.passage == nullptr) return made;
  host::Instance& instance = **made;
  const weft_component& component = *instance.table;
  if (instance.nested.empty()) {  // made again by the passage: what it is made from has no handles
    void* again = nullptr;
    weft_error error = kNoError;
    const auto& values = subject.spec().arguments.values();
    const std::int32_t status = host::call_library(instance.id.c_str(), error, [&] {
      return how_.passage->create(component, host::made_from(values), &again, &error);
    });
    if (status != WEFT_OK) return host::plugin_error(status, error, instance.id);
    std::swap(instance.self, again);
    host::call_library(instance.id.c_str(), error,
                       [&] { how_.passage->destroy(component, again); });
  }
  weft_component table = component;
  table.prepare = &Passed::prepare;
  table.process = &Passed::process;
  table.destroy = &Passed::destroy;
  passed_.push_back(
      std::make_unique<Passed>(Passed{*how_.passage, component, instance.self, table}));
  instance.table = &passed_.back()->table;
  instance.self = passed_.back().get();
  return &instance;
}

Result<void> Performer::begin(const Template& templ, const Camera& camera) {
  if (auto created = create(); !created) return created;
  return prepare(templ, camera);
}

Result<void> Performer::create() {
  const auto instance = made(*subject_);
  if (!instance) return instance.error();
  instance_ = *instance;
  if (!subject_->warp_maker) return {};
  const auto maker = context_.instantiate(*subject_->warp_maker, "warps");
  if (!maker) return maker.error();
  warp_maker_ = *maker;
  return {};
}

Result<void> Performer::prepare(const Template& templ, const Camera& camera) {
  const HostRecord template_record = hold(templ), camera_record = hold(camera);
  if (warp_maker_ != nullptr) {
    if (auto ready = context_.prepare(*warp_maker_, *template_record, *camera_record); !ready)
      return ready;
  }
  const PipelinePart part = subject_->rules().part;
  if (part == PipelinePart::source || part == PipelinePart::templ) return {};
  return context_.prepare(*instance_, *template_record, *camera_record);
}

Result<void> Performer::replace(const Subject& changed, const Template& templ,
                                const Camera& camera) {
  const auto instance = made(changed);
  if (!instance) return instance.error();
  const PipelinePart part = changed.rules().part;
  if (part != PipelinePart::source && part != PipelinePart::templ) {
    if (auto ready = context_.prepare(**instance, *hold(templ), *hold(camera)); !ready)
      return ready;
  }
  context_.replace(*instance_, **instance);
  instance_ = *instance;
  subject_ = &changed;
  return {};
}

Answer Performer::call(int method, const std::vector<Input>& inputs, std::uint64_t frame) {
  std::vector<weft_record> views, of_fit;
  for (const Input& given : inputs) {
    views.push_back(given.record->view(given.slot.c_str()));
    const bool fits = given.slot == "correspondences" || given.slot == "template";
    if (fits) of_fit.push_back(views.back());
  }
  host::RecordPtr warp;
  if (warp_maker_ != nullptr && of_fit.size() == 2) {
    warp = context_.call(*warp_maker_, kRunStage, of_fit, frame).find("warp");
    if (warp != nullptr) views.push_back(warp->view("warp"));
  }
  Answer answer = answer_of(context_.call(*instance_, method, views, frame));
  context_.times().take();  // or they would grow
  return answer;
}

Answer Performer::evaluate(const HostRecord& warp, const Points& points) {
  return answer_of(context_.evaluate(*warp, points, 0));
}

}  // namespace weft::testing
