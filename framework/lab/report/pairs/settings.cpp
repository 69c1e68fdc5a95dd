// SPDX-License-Identifier: Apache-2.0
#include "lab/report/pairs/settings.hpp"

#include <map>
#include <set>

#include "yaml/yaml.hpp"

namespace weft::lab {
namespace {

using Settings = std::map<std::string, std::string>;  ///< "solvers.params.damping" to its value

std::string entry_name(const yaml::Node& item, std::size_t index) {
  for (const char* key : {"as", "use"}) {
    const yaml::Node* found = item.find(key);
    if (found != nullptr && found->kind == yaml::Kind::scalar) return found->scalar;
  }
  return std::to_string(index);
}

void flatten(const yaml::Node& node, const std::string& path, Settings& settings) {
  const std::string prefix = path.empty() ? "" : path + ".";
  for (const yaml::Entry& entry : node.entries) {
    flatten(entry.value, prefix + entry.key, settings);
  }
  for (std::size_t i = 0; i < node.items.size(); ++i) {
    flatten(node.items[i], prefix + entry_name(node.items[i], i), settings);
  }
  if (node.kind == yaml::Kind::scalar) settings[path] = node.scalar;
}

Settings settings_in(const std::string& text) {
  Settings settings;
  if (const auto document = yaml::parse(text, "")) flatten(document->root, "", settings);
  return settings;
}

}  // namespace

TextTable settings_sheet(const std::string& a, const std::string& b) {
  const Settings in_a = settings_in(a), in_b = settings_in(b);
  std::set<std::string> names;
  for (const auto* settings : {&in_a, &in_b}) {
    for (const auto& [name, value] : *settings) names.insert(name);
  }
  TextTable table{"settings", "Settings that differ", "", {}, {}};
  table.columns = {{"setting", "setting"}, {"A", "a"}, {"B", "b"}};
  const auto value_in = [](const Settings& settings, const std::string& name) {
    const auto found = settings.find(name);
    return found == settings.end() ? TextCell{"–", ""} : text_cell(found->second);
  };
  for (const std::string& name : names) {
    TextCell left = value_in(in_a, name), right = value_in(in_b, name);
    if (left.shown == right.shown) continue;
    table.rows.push_back({{text_cell(name), std::move(left), std::move(right)}});
  }
  return table;
}

bool have_same_source(const std::string& a, const std::string& b) {
  const auto source_of = [](Settings settings) {
    // How it is run, such as `isolate`, changes no frame.
    std::erase_if(settings, [](const auto& each) {
      return each.first != "source.use" && !each.first.starts_with("source.params.");
    });
    return settings;
  };
  const Settings source = source_of(settings_in(a));
  return !source.empty() && source == source_of(settings_in(b));
}

}  // namespace weft::lab
