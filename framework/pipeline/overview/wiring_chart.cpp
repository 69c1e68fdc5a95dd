// SPDX-License-Identifier: Apache-2.0
#include "pipeline/overview/wiring_chart.hpp"

#include <algorithm>
#include <weft/core/index.hpp>

namespace weft {
namespace {

class Charting {
 public:
  Charting(const CheckedPipeline& pipeline, const std::map<std::string, double>& times_ms)
      : pipeline_(pipeline), times_ms_(times_ms), columns_(pipeline.graph.values.size()) {}

  WiringChart chart() {
    const PipelineConfig& config = pipeline_.config;
    add_givers();
    for (std::size_t i = 0; i < config.stages.size(); ++i) {
      const Node& node = pipeline_.graph.stages[i];
      add_row(config.stages[i].name, id_of(config.stages[i]), node.inputs, node.outputs);
    }
    for (std::size_t i = 0; i < config.sinks.size(); ++i) {
      add_row(config.sinks[i].name, id_of(config.sinks[i]), pipeline_.graph.sinks[i].inputs, {});
    }
    return std::move(chart_);
  }

 private:
  static std::string id_of(const StageConfig& stage) { return stage.component.component().id; }

  /// Rows of what exists before the first stage.
  void add_givers() {
    const PipelineConfig& config = pipeline_.config;
    const auto given_by = [&](const char* name) {
      std::vector<int> values;
      for (std::size_t i = 0; i < pipeline_.graph.values.size(); ++i) {
        const ValueInfo& value = pipeline_.graph.values[i];
        const bool is_shown = value.lag == 0 ? value.name != "host" : is_read(static_cast<int>(i));
        if (value.stage < 0 && value.name == name && is_shown) {
          values.push_back(static_cast<int>(i));
        }
      }
      return values;
    };
    add_row("source", config.source ? id_of(*config.source) : "", {}, given_by("sources"));
    add_row("template", config.templ ? id_of(*config.templ) : "", {}, given_by("templates"));
    const std::vector<int> earlier = given_by("previous");
    if (!earlier.empty()) add_row("earlier frames", "", {}, earlier);
  }

  bool is_read(int value) const {
    const auto reads = [value](const Node& node) {
      return std::any_of(node.inputs.begin(), node.inputs.end(),
                         [value](const InputLink& link) { return link.value == value; });
    };
    const Graph& graph = pipeline_.graph;
    return std::any_of(graph.stages.begin(), graph.stages.end(), reads) ||
           std::any_of(graph.sinks.begin(), graph.sinks.end(), reads);
  }

  void add_row(const std::string& name, const std::string& id, const std::vector<InputLink>& inputs,
               const std::vector<int>& outputs) {
    const std::size_t row = chart_.rows.size();
    const auto time = times_ms_.find(name);
    WiringChart::Row added{name, id, {}, {}, {}};
    if (time != times_ms_.end()) added.ms = time->second;
    for (const InputLink& link : inputs) {
      const std::optional<std::size_t> column = columns_[to_index(link.value)];
      if (!column) continue;  // the host gives it to any sink
      chart_.values[*column].last_reader = row;
      added.inputs.push_back({*column, link.required});
    }
    for (const int value : outputs) {
      const ValueInfo& info = pipeline_.graph.values[to_index(value)];
      columns_[to_index(value)] = chart_.values.size();
      added.outputs.push_back(chart_.values.size());
      const std::string lag = info.lag > 1 ? "@" + std::to_string(info.lag) : "";
      chart_.values.push_back({info.slot + lag, row, row});
    }
    chart_.rows.push_back(std::move(added));
  }

  const CheckedPipeline& pipeline_;
  const std::map<std::string, double>& times_ms_;
  std::vector<std::optional<std::size_t>> columns_;  ///< by value of the graph
  WiringChart chart_;
};

}  // namespace

WiringChart wiring_chart(const CheckedPipeline& pipeline,
                         const std::map<std::string, double>& times_ms) {
  return Charting(pipeline, times_ms).chart();
}

}  // namespace weft
