// SPDX-License-Identifier: Apache-2.0
#include "lab/ablation/worst_frames.hpp"

#include <fmt/core.h>
#include <stdlib.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "host/roles/role_rules.hpp"

namespace weft::lab {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostFrames = 2;

/// A folder that is gone with this object.
class Scratch {
 public:
  Scratch() {
    std::error_code code;
    path_ = (fs::temp_directory_path(code) / "weft-XXXXXX").string();
    if (mkdtemp(path_.data()) == nullptr) path_.clear();
  }
  ~Scratch() {
    std::error_code code;
    if (!path_.empty()) fs::remove_all(path_, code);
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;

  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

/// The sink, prepared and open: its stills go into `folder`/worst.
Result<host::Instance*> open_sink(const host::ComponentSpec& spec, host::ExecutionContext& context,
                                  const host::RecordPtr& templ, const host::RecordPtr& camera) {
  auto sink = context.instantiate(spec, "sinks");
  if (!sink) return sink;
  if (auto ready = context.prepare(**sink, *templ, *camera); !ready) return ready.error();
  const host::Outcome opened = context.call(**sink, kOpenSink, {}, host::kOfflineFrame);
  if (!opened.usable()) return opened.error;
  return sink;
}

std::optional<host::ComponentSpec> resolve_sink(const std::string& text,
                                                const host::Registry& registry,
                                                const std::string& folder) {
  const auto component = yaml::parse(text, "");
  if (!component || component->root.find("use") == nullptr) return std::nullopt;
  std::vector<yaml::Problem> problems;
  return host::resolve_component(registry, *component->root.find("use"),
                                 component->root.find("params"),
                                 host::PathRules::of_process({folder}, folder), problems);
}

}  // namespace

void WorstFrames::add(const FrameMetrics& frame, host::NamedRecords records) {
  const bool has_image = std::any_of(records.begin(), records.end(), [](const auto& record) {
    return record.first == "image" && record.second != nullptr;
  });
  if (!frame.error || !has_image) return;
  const auto before = std::find_if(frames_.begin(), frames_.end(), [&](const Frame& other) {
    return other.error_mm < frame.error->mean_mm;
  });
  frames_.insert(before, {frame.frame, frame.error->mean_mm, std::move(records)});
  if (frames_.size() > kMostFrames) frames_.pop_back();
}

std::vector<std::pair<std::string, std::string>> WorstFrames::draw(
    const std::string& sink_text, const host::Registry& registry, host::ExecutionContext& context,
    const host::RecordPtr& templ, const host::RecordPtr& camera) const {
  std::vector<std::pair<std::string, std::string>> pictures;
  const Scratch scratch;
  if (frames_.empty() || scratch.path().empty()) return pictures;
  const auto spec = resolve_sink(sink_text, registry, scratch.path());
  if (!spec) return pictures;
  const auto sink = open_sink(*spec, context, templ, camera);
  if (!sink) return pictures;
  for (const Frame& frame : frames_) {
    std::vector<weft_record> inputs{templ->view("template"), camera->view("camera")};
    for (const auto& [slot, record] : frame.records) {
      if (record != nullptr) inputs.push_back(record->view(slot.c_str()));
    }
    context.call(**sink, kWriteFrame, inputs, frame.index);
  }
  // A sink may write its files later than the call of their frame, but not later than here.
  context.call(**sink, kFinishSink, {}, host::kOfflineFrame);
  for (const Frame& frame : frames_) {
    const std::string name = fmt::format("{:06}.png", frame.index);
    std::ifstream stream(scratch.path() + "/worst/" + name, std::ios::binary);
    if (stream)
      pictures.emplace_back("worst_" + name,
                            std::string(std::istreambuf_iterator<char>(stream), {}));
  }
  return pictures;
}

}  // namespace weft::lab
