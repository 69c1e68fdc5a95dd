// SPDX-License-Identifier: Apache-2.0
#include "pipeline/dumps/dump.hpp"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <set>
#include <sstream>
#include <weft/core/component_id.hpp>
#include <weft/core/index.hpp>
#include <weft/core/suggest.hpp>
#include <weft/core/whole_file.hpp>

#include "host/loading/secrets.hpp"

namespace weft {
namespace {

namespace fs = std::filesystem;
using host::Record;
using host::RecordPtr;

constexpr const char* kCall = "call";

/// True if a record is the same in all calls.
bool is_constant(const std::string& slot) { return slot == "template" || slot == "camera"; }

yaml::Node stage_node(const StageConfig& stage) {
  yaml::Node node;
  node.kind = yaml::Kind::map;
  node.entries = {{"stage", {}, yaml::text_node(stage.name)},
                  {"component", {}, host::without_secrets(stage.component)}};
  return node;
}

std::string stage_yaml(const PipelineConfig& config, const StageConfig& stage) {
  yaml::Node root = stage_node(stage);
  root.entries.insert(root.entries.begin(), {"weft", {}, yaml::plain_node("1")});
  root.entries.push_back({"seed", {}, yaml::plain_node(std::to_string(config.seed))});
  root.entries.push_back(
      {"build_id", {}, yaml::text_node(stage.component.installed->library->build_id)});
  yaml::Node producers;
  producers.kind = yaml::Kind::sequence;
  for (const StageConfig& other : config.stages) {
    if (rules_of(other.role).samples) producers.items.push_back(stage_node(other));
  }
  root.entries.push_back({"producers", {}, std::move(producers)});
  return yaml::emit(root);
}

void put_text(Record& record, const char* array, const std::string& text) {
  const auto length = static_cast<std::int64_t>(text.size());
  std::copy(text.begin(), text.end(),
            static_cast<char*>(record.allocate(array, WEFT_U8, 1, &length)));
}

void put_number(Record& record, const char* array, std::int64_t number) {
  *static_cast<std::int64_t*>(record.allocate(array, WEFT_I64, 0, nullptr)) = number;
}

/// An array of a call, or null when the file has none of this kind.
const weft_array* find(const Record& call, const char* name, std::int32_t dtype, int ndim) {
  const weft_array* array = find_array(call.view(""), name);
  return array != nullptr && array->dtype == dtype && array->ndim == ndim ? array : nullptr;
}

std::string text_of(const weft_array& array) {
  return {static_cast<const char*>(array.data), to_index(array.shape[0])};
}

/// The name of the next input of a slot: "in.correspondences", then "in.correspondences#2".
std::string record_name(const std::string& slot, std::map<std::string, int>& seen) {
  const int number = ++seen[slot];
  return "in." + slot + (number > 1 ? "#" + std::to_string(number) : "");
}

RecordPtr find(const host::NamedRecords& records, const std::string& name) {
  for (const auto& [slot, record] : records) {
    if (slot == name) return record;
  }
  return nullptr;
}

Error damaged(const std::string& file, const std::string& what) {
  return {Errc::invalid_data, what + "; was it written by weft run --dump?", file};
}

Result<void> check(const host::NamedRecords& records, const std::string& file) {
  for (const auto& [slot, record] : records) {
    if (slot == kCall || is_vendor_record(record->type())) continue;  // for Replay::check()
    const auto valid = host::validate(record->view(slot.c_str()));
    if (!valid) return damaged(file, "slot '" + slot + "': " + valid.error().message);
  }
  return {};
}

/// The inputs by the lines "slot record producer".
Result<std::vector<GivenRecord>> read_inputs(const std::string& lines,
                                             const host::NamedRecords& records,
                                             const DumpedStage& stage, const std::string& file) {
  std::vector<GivenRecord> inputs;
  std::istringstream stream(lines);
  for (std::string line; std::getline(stream, line);) {
    std::istringstream words(line);
    GivenRecord input;
    std::string name;
    words >> input.slot >> name >> input.producer;
    input.record = is_constant(input.slot) ? (input.slot == "template" ? stage.templ : stage.camera)
                                           : find(records, name);
    if (input.record == nullptr) return damaged(file, "lacks the input '" + name + "'");
    inputs.push_back(std::move(input));
  }
  return inputs;
}

Result<yaml::Node> read_yaml(const std::string& file) {
  const auto text = yaml::read_text(file);
  if (!text) return text.error();
  auto document = yaml::parse(*text, file);
  if (!document) return document.error();
  if (!document->problems.empty()) return damaged(file, document->problems.front().message);
  return std::move(document->root);
}

/// Stage and component of a node that stage_node made.
Result<void> read_stage(const yaml::Node& node, const std::string& file, std::string& name,
                        yaml::Node& component) {
  const yaml::Node* stage = node.find("stage");
  const yaml::Node* made = node.find("component");
  if (stage == nullptr || made == nullptr || made->find("use") == nullptr) {
    return damaged(file, "names no stage with its component");
  }
  name = stage->scalar;
  component = *made;
  return {};
}

}  // namespace

std::string dumped_call_name(std::uint64_t frame) {
  char name[32];
  std::snprintf(name, sizeof(name), "%06llu.npz", static_cast<unsigned long long>(frame));
  return name;
}

Result<void> Dump::check_names(const PipelineConfig& config,
                               const std::vector<std::string>& stages) {
  std::vector<std::string> known;
  for (const StageConfig& stage : config.stages) known.push_back(stage.name);
  for (const std::string& name : stages) {
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    std::string list;
    for (const std::string& each : known) list += (list.empty() ? "" : ", ") + each;
    return Error{
        Errc::not_found,
        "no stage is called '" + name + "'" + did_you_mean(name, known, "; there are: " + list),
        "--dump"};
  }
  return {};
}

Result<Dump> Dump::create(const std::string& run_folder, const PipelineConfig& config,
                          const std::vector<std::string>& stages, RecordPtr templ,
                          RecordPtr camera) {
  Dump dump(run_folder + "/dumps");
  for (const StageConfig& stage : config.stages) {
    if (std::find(stages.begin(), stages.end(), stage.name) == stages.end()) continue;
    const std::string folder = dump.folder_ + "/" + stage.name;
    std::error_code code;
    fs::create_directories(folder, code);
    if (code) return Error{Errc::io, "cannot be created: " + code.message(), folder};
    auto written = write_whole(stage_yaml(config, stage), folder + "/stage.yaml");
    if (!written) return written.error();
    written = host::write_npz(folder + "/template.npz", {{"template", templ}, {"camera", camera}});
    if (!written) return written.error();
  }
  return dump;
}

Result<void> Dump::add(const FrameResult& frame) const {
  for (const StageCall& call : frame.calls) {
    const std::string file = folder_ + "/" + call.stage + "/" + dumped_call_name(call.frame);
    if (auto written = write_call(file, call); !written) return written;
  }
  return {};
}

Result<void> write_call(const std::string& file, const StageCall& call) {
  host::NamedRecords records;
  std::map<std::string, int> seen;
  std::string lines, reason = call.outcome.error.message;
  // A record that cannot be fetched from a device made the stage fail, or was never requested.
  const auto add = [&](const std::string& name, const RecordPtr& record) {
    auto here = record->in_host_memory();
    if (!here) {
      reason +=
          (reason.empty() ? "" : "; ") + name + " is not in this file: " + here.error().message;
      return false;
    }
    records.emplace_back(name, *std::move(here));
    return true;
  };
  for (const GivenRecord& input : call.inputs) {
    const bool constant = is_constant(input.slot);
    const std::string name = constant ? input.slot : record_name(input.slot, seen);
    if (constant || add(name, input.record)) {
      lines += input.slot + " " + name + " " + input.producer + "\n";
    }
  }
  for (const auto& [slot, record] : call.outcome.outputs) add("out." + slot, record);
  auto facts = std::make_shared<Record>(kCall);
  put_number(*facts, "frame", static_cast<std::int64_t>(call.frame));
  put_number(*facts, "status", call.outcome.status);
  put_text(*facts, "reason", reason);
  put_text(*facts, "inputs", lines);
  records.emplace_back(kCall, std::move(facts));
  return host::write_npz(file, records, Durability::unsynced);
}

Result<DumpedStage> read_dumped_stage(const std::string& folder) {
  const std::string file = folder + "/stage.yaml";
  const auto root = read_yaml(file);
  if (!root) return root.error();
  DumpedStage stage;
  stage.folder = folder;
  if (auto read = read_stage(*root, file, stage.name, stage.component); !read) return read.error();
  const yaml::Node* seed = root->find("seed");
  const auto number = seed != nullptr ? yaml::as_int64(*seed) : std::nullopt;
  if (!number) return damaged(file, "has no seed");
  stage.seed = static_cast<std::uint64_t>(*number);
  if (const yaml::Node* build = root->find("build_id")) stage.build_id = build->scalar;
  if (const yaml::Node* producers = root->find("producers")) {
    for (const yaml::Node& item : producers->items) {
      auto& [name, component] = stage.producers.emplace_back();
      if (auto read = read_stage(item, file, name, component); !read) return read.error();
    }
  }
  const auto constants = host::read_npz(folder + "/template.npz");
  if (!constants) return constants.error();
  stage.templ = find(*constants, "template");
  stage.camera = find(*constants, "camera");
  if (stage.templ == nullptr || stage.camera == nullptr) {
    return damaged(folder + "/template.npz", "lacks the template or the camera");
  }
  return stage;
}

Result<StageCall> read_call(const std::string& file, const DumpedStage& stage) {
  // The record of the call itself is in no catalogue.
  const auto records = host::read_npz(file, host::NpzCheck::none);
  if (!records) return records.error();
  const RecordPtr facts = find(*records, kCall);
  if (facts == nullptr) return damaged(file, "lacks the slot 'call'");
  const weft_array* frame = find(*facts, "frame", WEFT_I64, 0);
  const weft_array* status = find(*facts, "status", WEFT_I64, 0);
  const weft_array* reason = find(*facts, "reason", WEFT_U8, 1);
  const weft_array* lines = find(*facts, "inputs", WEFT_U8, 1);
  if (frame == nullptr || status == nullptr || reason == nullptr || lines == nullptr) {
    return damaged(file, "does not state which call it contains");
  }
  if (auto valid = check(*records, file); !valid) return valid.error();
  auto inputs = read_inputs(text_of(*lines), *records, stage, file);
  if (!inputs) return inputs.error();
  StageCall call{stage.name,
                 static_cast<std::uint64_t>(*static_cast<std::int64_t*>(frame->data)),
                 *std::move(inputs),
                 {}};
  const std::int64_t number = *static_cast<std::int64_t*>(status->data);
  if (number < WEFT_OK || number > WEFT_END) return damaged(file, "has an unknown status");
  call.outcome.status = static_cast<weft_status>(number);
  call.outcome.error.message = text_of(*reason);
  constexpr std::string_view kOut = "out.";
  for (const auto& [name, record] : *records) {
    if (name.starts_with(kOut)) call.outcome.outputs.emplace_back(name.substr(kOut.size()), record);
  }
  return call;
}

}  // namespace weft
