// SPDX-License-Identifier: Apache-2.0
#include "testing/contract_subject.hpp"

#include <stdlib.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <weft/core/index.hpp>
#include <weft/testing/role_contract.hpp>

#include "host/calling/protected_inputs.hpp"
#include "host/loading/component_checks.hpp"

namespace weft::testing {
namespace {

/// The stage by which all instances draw, so that their draws are the same.
constexpr const char* kStage = "contract";
constexpr std::uint64_t kRunSeed = kContractSeed;

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
  std::vector<yaml::Problem> problems = document->problems;
  std::optional<host::ComponentSpec> spec;
  if (problems.empty()) {
    const std::string here = std::filesystem::current_path().string();
    spec = host::resolve_component(registry, *document->root.find("use"),
                                   document->root.find("params"),
                                   host::PathRules::of_process({here}, output_folder), problems);
  }
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
                   "give parameters as CONTRACT \"{name: value}\" of weft_add_plugin, or "
                   "behind the id: weft_contract " +
                   id + " \"{name: value}\"",
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

HeldRecord Answer::find(std::string_view slot) const {
  for (const auto& [name, record] : outputs) {
    if (name == slot) return record;
  }
  return nullptr;
}

std::string to_text(const Answer& answer) {
  constexpr const char* kNames[] = {"ok", "degenerate", "no_result", "error", "cancelled"};
  const std::string name = kNames[to_index(static_cast<std::int32_t>(answer.status))];
  return answer.message.empty() ? name : name + " (" + answer.message + ")";
}

std::string difference(const Answer& a, const Answer& b) {
  if (a.status != b.status) return "it says " + to_text(a) + ", not " + to_text(b);
  if (a.outputs.size() != b.outputs.size()) return "it makes other outputs";
  for (const auto& [slot, record] : a.outputs) {
    const HeldRecord other = b.find(slot);
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

Performer::Performer(const Subject& subject) : subject_(subject), lane_(kRunSeed, {}) {
  lane_.protect_inputs();
}

Result<void> Performer::begin(const Template& templ, const Camera& camera) {
  const auto made = lane_.instantiate(subject_.spec(), kStage);
  if (!made) return made.error();
  instance_ = *made;
  if (subject_.warp_maker) {
    const auto maker = lane_.instantiate(*subject_.warp_maker, "warps");
    if (!maker) return maker.error();
    warp_maker_ = *maker;
    if (auto ready = lane_.prepare(*warp_maker_, *hold(templ), *hold(camera)); !ready) return ready;
  }
  const PipelinePart part = subject_.rules().part;
  if (part == PipelinePart::source || part == PipelinePart::templ) return {};
  return lane_.prepare(*instance_, *hold(templ), *hold(camera));
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
    warp = lane_.call(*warp_maker_, kRunStage, of_fit, frame).find("warp");
    if (warp != nullptr) views.push_back(warp->view("warp"));
  }
  return answer_of(lane_.call(*instance_, method, views, frame));
}

Answer Performer::evaluate(const HeldRecord& warp, const Points& points) {
  return answer_of(lane_.evaluate(*warp, points, 0));
}

}  // namespace weft::testing
