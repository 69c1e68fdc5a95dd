// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <set>
#include <utility>
#include <weft/core/index.hpp>

#include "pipeline/graph/wiring.hpp"

namespace weft {
namespace {

/// Finds stages whose work is lost, in what is left without those that are `gone`.
class Readers {
 public:
  Readers(const PipelineConfig& config, const Graph& graph, const OpenReading& open,
          std::set<std::size_t> gone = {})
      : config_(config), graph_(graph), open_(open), gone_(std::move(gone)) {
    for (std::size_t i = 0; i < graph.stages.size(); ++i) {
      if (gone_.count(i) > 0) continue;
      for (const InputLink& input : graph.stages[i].inputs) note(input, by_stages_);
    }
    for (std::size_t i = 0; i < graph.sinks.size(); ++i) {
      for (const InputLink& input : graph.sinks[i].inputs) {
        note(input, chooses(config.sinks[i], input.slot) ? by_choosing_sinks_ : by_sinks_);
      }
    }
  }

  bool is_lost(std::size_t stage) const {
    if (open_.conditions || decides(static_cast<int>(stage))) return false;
    const std::vector<int>& outputs = graph_.stages[stage].outputs;
    const auto read = [&](int value) { return may_be_read(value) || is_read(value); };
    return !outputs.empty() && std::none_of(outputs.begin(), outputs.end(), read);
  }

  /// Message about a stage whose outputs are lost; `fix` describes how to omit it.
  std::string complaint(std::size_t stage, const std::string& fix) const {
    const std::vector<int>& outputs = graph_.stages[stage].outputs;
    const auto late = std::find_if(outputs.begin(), outputs.end(),
                                   [&](int value) { return needed_earlier(value) != nullptr; });
    if (late != outputs.end()) return too_late(*late, fix);
    const int lost = outputs.front();
    const ValueInfo& value = info(lost);
    const std::string next = next_maker(lost);
    const bool named = config_.stages[stage].named;
    return "no component reads " + what_of(value) +
           (next.empty() ? "" : ", because '" + next + "' makes new ones") + "; " +
           (named ? "" : "name it with as: NAME and ") + "take what it makes with from: {" +
           value.slot + ": " + (named ? value.name : "NAME") + "}, or " + fix;
  }

 private:
  const ValueInfo& info(int value) const { return graph_.values[to_index(value)]; }

  /// True if this stage determines which others are called.
  bool decides(int stage) const {
    for (std::size_t i = 0; i < graph_.stages.size(); ++i) {
      const std::vector<int>& asked = graph_.stages[i].not_ok;
      const bool asks = std::find(asked.begin(), asked.end(), stage) != asked.end();
      if (asks && gone_.count(i) == 0) return true;
    }
    return false;
  }

  static std::string what_of(const ValueInfo& value) {
    return "the " + value.slot + " of '" + value.name + "'";
  }

  std::string too_late(int lost, const std::string& fix) const {
    const ValueInfo& value = info(lost);
    const std::string& earlier = needed_earlier(lost)->name;
    const std::string where = what_of(value) + ", which comes after '" + earlier +
                              "'; move it up, before '" + earlier + "', or " + fix;
    if (by_sinks_.count(lost) == 0) return "no component reads " + where;
    return "only sinks read " + where + "; a sink that shows it needs from: {" + value.slot + ": " +
           value.name + "}";
  }

  static bool chooses(const StageConfig& sink, const std::string& slot) {
    return std::any_of(sink.from.begin(), sink.from.end(),
                       [&](const FromRule& rule) { return rule.slot == slot; });
  }

  void note(const InputLink& input, std::set<int>& readers) {
    readers.insert(input.value);
    if (info(input.value).lag > 0) fed_back_.insert(info(input.value).slot);
  }

  bool may_be_read(int value) const {
    return open_.slots.count(info(value).slot) > 0 ||
           (open_.before && info(value).stage < static_cast<int>(*open_.before));
  }

  /// The run folder takes shapes and registrations. If several solvers give shapes, it takes those
  /// of the last one. Registrations are measured for a reader. Records that are fed back are
  /// likewise the last that were made. A pipeline of films that takes unordered images has no frame
  /// that a visibility is fed back to: its run folder takes it.
  bool is_read(int value) const {
    const std::string& slot = info(value).slot;
    if (slot == "shape" || slot == "registration" || fed_back_.count("previous." + slot) > 0)
      return true;
    if (slot == "visibility" && !config_.is_sequence) return true;
    if (by_stages_.count(value) > 0 || by_choosing_sinks_.count(value) > 0) return true;
    // Matches behind the stages that make the shape out of matches are shown as if they were its.
    const bool late = slot == "correspondences" && needed_earlier(value) != nullptr;
    return by_sinks_.count(value) > 0 && !late;
  }

  /// The first stage that reads another value of this kind before this one is made, unless a later
  /// stage reads such values too. Matchers and filters hand matches on.
  const StageConfig* needed_earlier(int value) const {
    const std::string& slot = info(value).slot;
    const StageConfig* first = nullptr;
    for (std::size_t i = 0; i < graph_.stages.size(); ++i) {
      const RoleRules& rules = rules_of(config_.stages[i].role);
      if (gone_.count(i) > 0 || (rules.hands_on && contains(*rules.products, slot))) continue;
      const auto& inputs = graph_.stages[i].inputs;
      const bool reads = std::any_of(inputs.begin(), inputs.end(),
                                     [&](const InputLink& input) { return input.slot == slot; });
      if (!reads) continue;
      if (static_cast<int>(i) > info(value).stage) return nullptr;
      if (first == nullptr) first = &config_.stages[i];
    }
    return first;
  }

  /// The stage that makes the next value of this kind, empty when there is none.
  std::string next_maker(int value) const {
    for (std::size_t i = to_index(value) + 1; i < graph_.values.size(); ++i) {
      if (graph_.values[i].slot == info(value).slot) return graph_.values[i].name;
    }
    return {};
  }

  const PipelineConfig& config_;
  const Graph& graph_;
  const OpenReading& open_;
  std::set<std::size_t> gone_;
  std::set<int> by_stages_, by_sinks_, by_choosing_sinks_;
  std::set<std::string> fed_back_;
};

/// The stages that are lost, and those that are lost without them.
std::set<std::size_t> lost_stages(const PipelineConfig& config, const Graph& graph,
                                  const OpenReading& open) {
  std::set<std::size_t> lost;
  for (std::size_t before = graph.stages.size() + 1; before != lost.size();) {
    before = lost.size();
    const Readers readers(config, graph, open, lost);
    for (std::size_t i = 0; i < graph.stages.size(); ++i) {
      if (lost.count(i) == 0 && readers.is_lost(i)) lost.insert(i);
    }
  }
  return lost;
}

/// How to leave stages out by one setting.
std::string way_out(const PipelineConfig& config, const std::set<std::size_t>& lost) {
  std::string names;
  for (const std::size_t stage : lost) {
    names += (names.empty() ? "" : ",") + config.stages[stage].name;
  }
  return (lost.size() > 1 ? "omit all unused ones: --set without="
                          : "leave it out: --set without=") +
         names;
}

}  // namespace

void refuse_unread(const PipelineConfig& config, const Graph& graph, const OpenReading& open,
                   std::vector<yaml::Problem>& problems) {
  const auto solves = [](const StageConfig& stage) { return rules_of(stage.role).solves; };
  if (std::none_of(config.stages.begin(), config.stages.end(), solves)) return;
  const std::string fix = way_out(config, lost_stages(config, graph, open));
  const Readers readers(config, graph, open);
  for (std::size_t i = 0; i < graph.stages.size(); ++i) {
    if (readers.is_lost(i)) problems.push_back({config.stages[i].at, readers.complaint(i, fix)});
  }
}

}  // namespace weft
