// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <weft/core/index.hpp>
#include <weft/core/quote.hpp>
#include <weft/core/suggest.hpp>

#include "pipeline/graph/wiring.hpp"

namespace weft {
namespace {

/// True if a component makes values of this slot out of others. Filters only mark existing values.
bool can_make(const host::ComponentManifest& component, const std::string& slot) {
  return !rules_of(component.role()).marks && contains(products_of(component), slot);
}

/// "FILE:LINE".
std::string line_of(const PipelineConfig& config, yaml::Position at) {
  return escaped(config.sources.at(to_index(at.source)).name) + ":" + std::to_string(at.line);
}

/// The names of all values of this slot in the same frame.
Words makers_of(const Graph& graph, const std::string& slot) {
  Words names;
  for (const ValueInfo& value : graph.values) {
    if (value.slot == slot) names.push_back(value.name);
  }
  return names;
}

std::string comes_later(const std::string& name, const StageConfig& reader) {
  return "'" + name + "' comes later; move it up, before '" + reader.name + "'";
}

/// Message about a name that no stage bears, empty if nothing is known of it.
std::string no_stage(const PipelineConfig& config, const std::string& name) {
  for (const StageConfig& sink : config.sinks) {
    if (sink.name == name) return "'" + name + "' is a sink, which makes nothing to be read";
  }
  for (const LeftOut& gone : config.left_out) {
    if (gone.name == name) return "'" + name + "' is omitted by " + line_of(config, gone.at);
  }
  return {};
}

/// Message about a stage at or behind the reader, empty when there is none.
std::string later_stage(const PipelineConfig& config, const StageConfig& reader,
                        const std::string& slot, const std::string& name) {
  for (const StageConfig& stage : config.stages) {
    if (stage.name != name) continue;
    const auto made = products_of(stage);
    if (made && !contains(*made, slot))
      return "'" + name + "' makes " + joined(*made) + ", not '" + slot + "'";
    if (&stage == &reader) {
      return "'" + name + "' cannot read what it makes itself; what it made one frame ago is " +
             "previous." + slot;
    }
    return comes_later(name, reader);
  }
  return {};
}

}  // namespace

std::vector<std::string> products_of(const host::ComponentManifest& component) {
  return rules_of(component.role()).products.value_or(component.produces);
}

std::optional<Words> products_of(const StageConfig& stage) {
  if (stage.component.installed != nullptr) return products_of(stage.component.component());
  return rules_of(stage.role).products;
}

const RoleRules& rules_of(const StageConfig& stage) {
  return stage.component.installed != nullptr ? stage.component.component().rules()
                                              : rules_of(stage.role);
}

std::string other_record(const StageConfig& reader, const std::string& slot,
                         const StageConfig& maker) {
  if (reader.component.installed == nullptr || maker.component.installed == nullptr) return {};
  const host::ComponentManifest& reads = reader.component.component();
  const host::ComponentManifest& makes = maker.component.component();
  const auto type_in = [](const std::vector<RoleSlot>& slots, const std::string& name) {
    const auto found = std::find_if(slots.begin(), slots.end(),
                                    [&](const RoleSlot& each) { return each.name == name; });
    return found != slots.end() ? found->type : std::string();
  };
  const std::string earlier = "previous.";
  const std::string made = slot.substr(slot.starts_with(earlier) ? earlier.size() : 0);
  const std::string wanted = type_in(reads.rules().main_method().inputs, slot);
  const std::string given = type_in(makes.rules().main_method().outputs, made);
  const host::RecordSchema *as_read = reads.schema_of(wanted), *as_made = makes.schema_of(given);
  if (as_read == nullptr || as_made == nullptr || *as_read == *as_made) return {};
  if (wanted != given) {
    return reads.id + " reads " + wanted + ", and '" + maker.name + "' makes " + given +
           "; install versions of the two that agree";
  }
  return reads.id + " declares other arrays for " + wanted + " than " + makes.id +
         ", which makes it; install versions of the two that agree";
}

std::string without_sequence(const std::string& what) {
  return what +
         ": with 'sequence: false' no frame has one before it; take another component, or leave "
         "'sequence' out where the frames are a film";
}

std::string missing_input(const PipelineConfig& config, const host::Registry& registry,
                          const std::string& id, const std::string& slot) {
  if (!config.is_sequence && slot.starts_with("previous.")) {
    return without_sequence(id + " requires '" + slot + "'");
  }
  std::string message = id + " requires '" + slot + "', which no earlier stage produces";
  if (config.in_program) message += " and no program hands in";
  for (const LeftOut& gone : config.left_out) {
    const host::Installed* entry = registry.find(gone.use);
    if (entry == nullptr || !can_make(entry->component, slot)) continue;
    message += " ('" + gone.name + "' is omitted by " + line_of(config, gone.at) + ")";
  }
  Words producers;
  for (const host::Installed& entry : registry.installed()) {
    if (entry.shadowed || !can_make(entry.component, slot)) continue;
    // A program stands where the source would.
    const bool is_source = rules_of(entry.component.role()).part == PipelinePart::source;
    if (!config.in_program || !is_source) producers.push_back(entry.component.id);
  }
  if (producers.empty()) return message;
  return message + ";\n    add one that produces it: " + joined(producers);
}

std::string wrong_name(const PipelineConfig& config, const Graph& graph, const StageConfig& reader,
                       const std::string& slot, const std::string& name) {
  const Words makers = makers_of(graph, slot);
  Words made;
  for (const ValueInfo& value : graph.values) {
    if (value.name == name) made.push_back(value.slot);
  }
  if (!made.empty()) {
    return "'" + name + "' makes " + joined(made) + ", not '" + slot + "'" +
           (makers.empty() ? "" : "; that is made by: " + joined(makers));
  }
  if (std::string later = later_stage(config, reader, slot, name); !later.empty()) return later;
  if (std::string other = no_stage(config, name); !other.empty()) return other;
  Words meant = makers;
  for (const StageConfig& stage : config.stages) {
    if (stage.component.installed == nullptr) meant.push_back(stage.name);  // it may make anything
  }
  return "no earlier stage named " + quote(name) + " produces '" + slot + "'" +
         did_you_mean(name, meant, "; name it with: as: " + escaped(name, 80));
}

std::string wrong_condition(const PipelineConfig& config, const StageConfig& reader,
                            const std::string& name) {
  Words earlier;
  for (const StageConfig& stage : config.stages) {
    if (&stage == &reader) break;
    earlier.push_back(stage.name);
  }
  if (contains(earlier, name)) return {};
  if (name == reader.name) return "'" + name + "' cannot wait for itself";
  for (const StageConfig& stage : config.stages) {
    if (stage.name == name) return comes_later(name, reader);
  }
  if (std::string other = no_stage(config, name); !other.empty()) return other;
  return "no earlier stage is named " + quote(name) + did_you_mean(name, earlier);
}

std::string nothing_to_unite(const Graph& graph, const StageConfig& reader,
                             const std::string& slot) {
  const std::string id = reader.component.component().id;
  const Words makers = makers_of(graph, slot);
  if (makers.size() < 2) {
    return id + " unites several '" + slot + "', but there is " +
           (makers.empty() ? "none" : "one") + "; leave it out";
  }
  return id + " unites several '" + slot + "', and without 'from' it is given the latest only; " +
         "choose from: {" + slot + ": [" + joined(makers) + "]}";
}

}  // namespace weft
