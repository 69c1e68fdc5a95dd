// SPDX-License-Identifier: Apache-2.0
#include "pipeline/steering/change_maker.hpp"

#include <algorithm>
#include <string_view>
#include <weft/core/index.hpp>
#include <weft/core/quote.hpp>

#include "pipeline/steering/settings_json.hpp"
#include "pipeline/steering/settings_list.hpp"

namespace weft {
namespace {

Error refused(std::string why) { return {Errc::unsupported, std::move(why)}; }

/// The keys of a component beside its parameters decide what it is, and what it reads and when.
bool is_parameter(std::string_view path) {
  static constexpr std::string_view kOthers[] = {"use",     "from",        "when",
                                                 "isolate", "deadline_ms", "overwrite"};
  const std::string_view key = path.substr(0, path.find('.'));
  return std::find(std::begin(kOthers), std::end(kOthers), key) == std::end(kOthers);
}

bool reads_the_same(const Node& a, const Node& b) {
  return std::equal(a.inputs.begin(), a.inputs.end(), b.inputs.begin(), b.inputs.end(),
                    [](const InputLink& x, const InputLink& y) {
                      return x.slot == y.slot && x.value == y.value && x.required == y.required;
                    });
}

/// A list of what the stage is, on frames and on the template.
yaml::Node component_of(const StageConfig& stage) {
  yaml::Node list;
  list.kind = yaml::Kind::sequence;
  list.items.push_back(stage.component.effective);
  if (stage.on_template) list.items.push_back(stage.on_template->effective);
  return list;
}

}  // namespace

ChangeMaker::ChangeMaker(const CheckedPipeline& pipeline, StageMaker maker, Check check)
    : pipeline_(pipeline), maker_(std::move(maker)), check_(std::move(check)) {
  for (const StageConfig& stage : pipeline.config.stages) {
    components_.push_back(component_of(stage));
  }
}

Result<PipelineChange> ChangeMaker::make(const std::string& setting) {
  const auto stage = stage_of(setting);
  if (!stage) return stage.error();
  std::vector<std::string> settings = with_settings(settings_, {setting});
  auto checked = check_(settings);
  if (!checked) return checked.error();
  auto change = changed(*stage, *std::move(checked));
  if (change) settings_ = std::move(settings);
  return change;
}

Result<std::size_t> ChangeMaker::stage_of(const std::string& setting) const {
  const std::string_view path = path_of(setting);
  const std::size_t dot = path.find('.');
  const std::string_view name = path.substr(0, dot);
  const std::vector<StageConfig>& stages = pipeline_.config.stages;
  const auto found = std::find_if(stages.begin(), stages.end(),
                                  [&](const StageConfig& stage) { return stage.name == name; });
  const bool is_set = path.size() < setting.size() && dot != std::string_view::npos;
  if (found == stages.end() || !is_set || !is_parameter(path.substr(dot + 1))) {
    return refused(quote(path) +
                   " cannot change while the run goes on; parameters of stages can, such as "
                   "filters.alpha_s=0.2");
  }
  if (const std::string why = why_fixed(*found, pipeline_.config); !why.empty()) {
    return refused(quote(name) + " cannot change while the run goes on: " + why);
  }
  return to_index(found - stages.begin());
}

Result<PipelineChange> ChangeMaker::changed(std::size_t stage, CheckedPipeline checked) {
  checked.config.file = pipeline_.config.file;  // not the copy in the run folder
  PipelineChange change{{}, settings_json(checked.config)};
  if (!reads_the_same(checked.graph.stages[stage], pipeline_.graph.stages[stage])) {
    return refused("'" + pipeline_.config.stages[stage].name +
                   "' would read other values; that cannot change while the run goes on");
  }
  const auto config = std::make_shared<StageConfig>(std::move(checked.config.stages[stage]));
  yaml::Node component = component_of(*config);
  if (component == components_[stage]) return change;
  auto made = maker_.make(*config);
  if (!made) return made.error();
  components_[stage] = std::move(component);
  change.stages.push_back({stage, config, *std::move(made)});
  return change;
}

Result<std::vector<std::string>> ChangeMaker::with_changes(
    const std::vector<std::string>& more) const {
  std::vector<std::string> settings = with_settings(settings_, more);
  const auto checked = check_(settings);
  if (!checked) return checked.error();
  return settings;
}

Result<std::string> ChangeMaker::yaml() const {
  std::string text = effective_yaml(pipeline_.config);
  if (settings_.empty()) return text;
  const auto checked = check_(settings_);
  if (!checked) return checked.error();
  // Stages that did not change keep their variables instead of secrets.
  auto begun = yaml::parse(text, "pipeline.yaml");
  auto now = yaml::parse(effective_yaml(checked->config), "pipeline.yaml");
  if (!begun) return begun.error();
  if (!now) return now.error();
  const yaml::Node* stages = now->root.find("stages");
  for (yaml::Entry& entry : begun->root.entries) {
    if (entry.key != "stages" || stages == nullptr) continue;
    for (std::size_t i = 0; i < components_.size(); ++i) {
      if (components_[i] == component_of(pipeline_.config.stages[i])) continue;
      entry.value.items[i] = stages->items[i];
    }
  }
  return yaml::emit(begun->root);
}

void ChangeMaker::discard(const PipelineChange& change) const {
  for (const StageChange& stage : change.stages) maker_.context.discard(*stage.made.instance);
}

}  // namespace weft
