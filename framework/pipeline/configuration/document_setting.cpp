// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <iterator>
#include <optional>
#include <weft/core/index.hpp>
#include <weft/core/quote.hpp>
#include <weft/core/suggest.hpp>

#include "pipeline/configuration/document.hpp"
#include "pipeline/configuration/document_merge.hpp"
#include "pipeline/configuration/pipeline_keys.hpp"
#include "pipeline/configuration/words.hpp"

namespace weft {
namespace {

/// The value of a setting, with the place of each of its keys.
struct Setting {
  struct Key {
    std::string text;
    yaml::Position at;
  };
  std::vector<Key> path;
  yaml::Node value;
};

yaml::Node map_of(const Setting::Key& key, yaml::Node value) {
  yaml::Node map;
  map.kind = yaml::Kind::map;
  map.at = key.at;
  map.entries.push_back({key.text, map.at, std::move(value)});
  return map;
}

yaml::Node list_of(yaml::Node item) {
  yaml::Node list;
  list.kind = yaml::Kind::sequence;
  list.at = item.at;
  list.items.push_back(std::move(item));
  return list;
}

void shift(yaml::Node& node, int columns) {
  node.at.column += columns;
  for (yaml::Node& item : node.items) shift(item, columns);
  for (yaml::Entry& entry : node.entries) {
    entry.at.column += columns;
    shift(entry.value, columns);
  }
}

/// The keys of a component that settings may set: all but its name, by which they find it.
const Words& settable_keys() {
  static const Words kKeys = [] {
    Words keys = yaml::names_of(place_of(PipelinePart::stage).keys);
    std::erase(keys, "as");
    return keys;
  }();
  return kKeys;
}

class Overlay {
 public:
  Overlay(const yaml::Node& root, const host::Registry& registry)
      : root_(root), registry_(registry) {}

  std::pair<yaml::Node, std::vector<yaml::Problem>> of(const std::string& text) {
    yaml::Node node;
    if (auto setting = split(text)) node = whole(std::move(*setting));
    return {std::move(node), std::move(problems_)};
  }

  /// A setting whose value has been read.
  std::pair<yaml::Node, std::vector<yaml::Problem>> of(const yaml::Entry& entry) {
    Setting setting;
    yaml::Node node;
    if (split_path(entry.key, entry.at, setting)) {
      setting.value = entry.value;
      node = whole(std::move(setting));
    }
    return {std::move(node), std::move(problems_)};
  }

 private:
  std::nullopt_t fail(yaml::Position at, std::string message) {
    problems_.push_back({at, std::move(message)});
    return std::nullopt;
  }
  std::nullopt_t fail(int column, std::string message) {
    return fail(yaml::Position{1, column}, std::move(message));
  }

  std::optional<Setting> split(const std::string& text) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos) {
      return fail(columns(text) + 1, "expected '=' and a value, such as filters.alpha_s=0.2");
    }
    Setting setting;
    if (!split_path(text.substr(0, equals), {1, 1}, setting)) return std::nullopt;
    auto value = value_of_setting(text, equals, problems_);
    if (!value) return std::nullopt;
    setting.value = *std::move(value);
    return setting;
  }

  /// The keys of a path that begins at `at`; false when one is empty or there are too many.
  bool split_path(const std::string& path, yaml::Position at, Setting& setting) {
    for (std::size_t start = 0; start <= path.size();) {
      const std::size_t end = std::min(path.find('.', start), path.size());
      yaml::Position key_at = at;
      key_at.column += columns(path.substr(0, start));
      if (end == start) {
        const std::string next = end == path.size() ? "=" : path.substr(end, 1);
        fail(key_at, "expected a name before '" + next + "'");
        return false;
      }
      if (setting.path.size() == yaml::kMaxDepth) {
        fail(key_at, "more than " + std::to_string(yaml::kMaxDepth) + " names before '='");
        return false;
      }
      setting.path.push_back({path.substr(start, end - start), key_at});
      start = end + 1;
    }
    return true;
  }

  /// Keys of the path from `i` on, one inside the other.
  static yaml::Node nested(Setting& setting, std::size_t i) {
    if (i == setting.path.size()) return std::move(setting.value);
    return map_of(setting.path[i], nested(setting, i + 1));
  }

  /// The path inside a component: `params` may be omitted.
  yaml::Node component(Setting& setting, std::size_t i, const yaml::Node* base) const {
    if (i == setting.path.size()) return std::move(setting.value);
    const Setting::Key& key = setting.path[i];
    const bool own = contains(settable_keys(), key.text);
    if (own && !key.text.ends_with("params")) return nested(setting, i);
    const std::string block = own ? key.text : "params";
    const yaml::Node* params = base != nullptr ? base->find(block) : nullptr;
    const yaml::Node* use = base != nullptr ? base->find("use") : nullptr;
    return map_of({block, key.at},
                  parameter(setting, own ? i + 1 : i, params, use != nullptr ? use->scalar : ""));
  }

  /// `id` is the component that has these parameters.
  yaml::Node parameter(Setting& setting, std::size_t i, const yaml::Node* params,
                       const std::string& id) const {
    if (i == setting.path.size()) return std::move(setting.value);
    const std::string name = host::current_parameter(registry_, id, setting.path[i].text);
    const yaml::Node* own = params != nullptr ? params->find(name) : nullptr;
    const bool holds_component = own != nullptr && own->find("use") != nullptr;
    return map_of(setting.path[i],
                  holds_component ? component(setting, i + 1, own) : nested(setting, i + 1));
  }

  /// A path may end at a component only with a map; a plugin's id is meant for its key `use`.
  bool ends_well(const Setting& setting) {
    if (setting.path.size() > 1 || setting.value.kind == yaml::Kind::map) return true;
    const std::string& name = setting.path.front().text;
    const std::string& text = setting.value.scalar;
    const bool is_id = text.find('/') != std::string::npos;
    fail(setting.value.at, quote(name) + " is a component" +
                               (is_id ? "; did you mean " + escaped(name + ".use=" + text, 80) + "?"
                                      : "; set a key or parameter of it: " + name + ".KEY=VALUE"));
    return false;
  }

  yaml::Node whole(Setting setting) {
    const Setting::Key first = setting.path.front();
    for (const char* list : {"stages", "sinks"}) {
      const yaml::Node* stages = root_.find(list);
      if (stages == nullptr) continue;
      const std::vector<std::string> names = names_of_stages(*stages);
      const auto found = std::find(names.begin(), names.end(), first.text);
      if (found != names.end()) {
        if (!ends_well(setting)) return {};
        const yaml::Node& base = stages->items[to_index(found - names.begin())];
        return stage(setting, list, first, base);
      }
    }
    if (first.text == "source" || first.text == "template") {
      if (!ends_well(setting)) return {};
      return map_of(first, component(setting, 1, root_.find(first.text)));
    }
    static constexpr const char* kOfFiles[] = {"extends", "without", "stages", "sinks"};
    const bool of_files =
        std::find(std::begin(kOfFiles), std::end(kOfFiles), first.text) != std::end(kOfFiles);
    if (of_files && (setting.path.size() == 1 || first.text != "sinks")) {
      fail(first.at, "a setting cannot set " + quote(first.text) + "; write it into a file");
      return {};
    }
    if (setting.path.size() > 1) {
      fail(first.at, "no stage or sink is named " + quote(first.text) + suggestion(first.text));
      return {};
    }
    return nested(setting, 0);
  }

  yaml::Node stage(Setting& setting, const char* list, const Setting::Key& name,
                   const yaml::Node& base) const {
    yaml::Node item = component(setting, 1, &base);
    if (item.kind == yaml::Kind::map) {
      item.entries.push_back({"as", name.at, yaml::plain_node(name.text, name.at)});
    }
    return map_of({list, name.at}, list_of(std::move(item)));
  }

  std::string suggestion(const std::string& name) const {
    std::vector<std::string> known{"source", "template"};
    for (const char* list : {"stages", "sinks"}) {
      if (const yaml::Node* stages = root_.find(list)) {
        for (std::string& each : names_of_stages(*stages)) known.push_back(std::move(each));
      }
    }
    return did_you_mean(name, known);
  }

  const yaml::Node& root_;
  const host::Registry& registry_;
  std::vector<yaml::Problem> problems_;
};

}  // namespace

int columns(std::string_view text) {
  return static_cast<int>(std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U;
  }));
}

std::optional<yaml::Node> value_of_setting(const std::string& setting, std::size_t equals,
                                           std::vector<yaml::Problem>& problems) {
  const int column = columns(setting.substr(0, equals + 1));
  auto value = yaml::parse(setting.substr(equals + 1), "");
  if (!value) {
    const yaml::Position at = yaml::position_in(value.error().where, "");
    problems.push_back({{1, column + at.column}, value.error().message});
    return std::nullopt;
  }
  for (yaml::Problem& problem : value->problems) {
    problems.push_back({{1, column + problem.at.column}, std::move(problem.message)});
  }
  shift(value->root, column);
  return std::move(value->root);
}

std::pair<yaml::Node, std::vector<yaml::Problem>> overlay_of(const std::string& setting,
                                                             const yaml::Node& root,
                                                             const host::Registry& registry) {
  return Overlay(root, registry).of(setting);
}

std::pair<yaml::Node, std::vector<yaml::Problem>> overlay_of(const yaml::Entry& setting,
                                                             const yaml::Node& root,
                                                             const host::Registry& registry) {
  return Overlay(root, registry).of(setting);
}

}  // namespace weft
