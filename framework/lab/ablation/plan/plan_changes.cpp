// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <optional>
#include <weft/core/quote.hpp>
#include <weft/core/suggest.hpp>

#include "lab/ablation/plan/plan_document.hpp"
#include "lab/ablation/plan/plan_keys.hpp"
#include "pipeline/configuration/document_merge.hpp"

namespace weft::lab {
namespace {

/// The keys of a plan that the command line may change: all but those that make a file of it.
std::vector<std::string> settable_keys() {
  std::vector<std::string> keys = yaml::names_of(plan_keys());
  for (const char* of_files : {"weft", "extends", "without"}) std::erase(keys, of_files);
  return keys;
}

yaml::Entry* entry_of(yaml::Node& map, std::string_view key) {
  const auto found = std::find_if(map.entries.begin(), map.entries.end(),
                                  [&](const yaml::Entry& entry) { return entry.key == key; });
  return found != map.entries.end() ? &*found : nullptr;
}

std::vector<std::string> keys_of(const yaml::Node* map) {
  std::vector<std::string> keys;
  for (const yaml::Entry& entry : map != nullptr ? map->entries : std::vector<yaml::Entry>{}) {
    keys.push_back(entry.key);
  }
  return keys;
}

/// The entry whose key, which may have dots, is the first part of a path.
yaml::Entry* first_in(yaml::Node& map, const std::string& path) {
  yaml::Entry* longest = nullptr;
  for (yaml::Entry& entry : map.entries) {
    const bool fits = path == entry.key || path.starts_with(entry.key + ".");
    if (fits && (longest == nullptr || entry.key.size() > longest->key.size())) longest = &entry;
  }
  return longest;
}

/// Erases the value of an axis from the text, as a key or in a list.
bool erase_value(yaml::Node& axis, const std::string& name) {
  yaml::Entry* values = entry_of(axis, "values");
  if (values == nullptr) return false;
  return std::erase_if(values->value.entries,
                       [&](const yaml::Entry& entry) { return entry.key == name; }) +
             std::erase_if(values->value.items,
                           [&](const yaml::Node& item) { return item.scalar == name; }) >
         0;
}

std::vector<std::string> values_of(const yaml::Node& axis) {
  const yaml::Node* values = axis.find("values");
  std::vector<std::string> names = keys_of(values);
  for (const yaml::Node& item : values != nullptr ? values->items : std::vector<yaml::Node>{}) {
    names.push_back(item.scalar);
  }
  return names;
}

class LeavingOut {
 public:
  LeavingOut(yaml::Node& root, std::vector<yaml::Problem>& problems)
      : root_(root), problems_(problems) {}

  void leave_out(const yaml::Node& name) {
    if (name.kind != yaml::Kind::scalar) {
      return problem(name.at, "'without' must be a list of names: AXIS, AXIS.VALUE or data.NAME");
    }
    const std::string& path = name.scalar;
    if (path.starts_with("data.")) return leave_out_data(path.substr(5), name.at);
    yaml::Entry* axes = entry_of(root_, "axes");
    yaml::Entry* axis = axes != nullptr ? first_in(axes->value, path) : nullptr;
    if (axis == nullptr) {
      std::vector<std::string> known = keys_of(root_.find("axes"));
      for (const std::string& each : keys_of(root_.find("data"))) known.push_back("data." + each);
      return problem(name.at, "the plan has no axis " + quote(path) + did_you_mean(path, known));
    }
    const std::string key = axis->key;
    if (path != key) return leave_out_value(*axis, path.substr(key.size() + 1), name.at);
    std::erase_if(axes->value.entries, [&](const yaml::Entry& entry) { return entry.key == key; });
    forget([&](const std::string& named, const std::string&) { return named == key; });
  }

 private:
  void leave_out_value(yaml::Entry& axis, const std::string& value, yaml::Position at) {
    const std::string key = axis.key;
    if (!erase_value(axis.value, value)) {
      if (axis.value.find("use") != nullptr) return except(axis.value, value, at);
      const std::vector<std::string> known = values_of(axis.value);
      return problem(at, "the axis " + quote(key) + " has no value " + quote(value) +
                             did_you_mean(value, known));
    }
    forget([&](const std::string& named, const std::string& of) {
      return named == key && of == value;
    });
  }

  /// A component that `use` of an axis names.
  static void except(yaml::Node& axis, const std::string& value, yaml::Position at) {
    yaml::Entry* entry = entry_of(axis, "except");
    if (entry == nullptr) {
      axis.entries.push_back({"except", at, {}});
      entry = &axis.entries.back();
      entry->value.kind = yaml::Kind::sequence;
      entry->value.at = at;
    }
    entry->value.items.push_back(yaml::text_node(value, at));
  }

  void leave_out_data(const std::string& data, yaml::Position at) {
    yaml::Entry* all = entry_of(root_, "data");
    const auto is_it = [&](const yaml::Entry& entry) { return entry.key == data; };
    if (all == nullptr || std::erase_if(all->value.entries, is_it) == 0) {
      return problem(at, "the plan has no data " + quote(data) +
                             did_you_mean(data, keys_of(root_.find("data"))));
    }
    forget([&](const std::string& named, const std::string& of) {
      return (named == "data" && of == data) ||
             (named == "sequence" && (of == data || of.starts_with(data + "_")));
    });
  }

  /// Comparisons and expectations that name an omitted part are omitted too.
  template <class Is>
  void forget(const Is& is_left_out) {
    const auto text = [](const yaml::Node& map, const char* key) {
      const yaml::Node* value = map.find(key);
      return value != nullptr ? value->scalar : std::string();
    };
    if (yaml::Entry* comparisons = entry_of(root_, "comparisons")) {
      std::erase_if(comparisons->value.items, [&](const yaml::Node& item) {
        return is_left_out(text(item, "axis"), text(item, "reference"));
      });
    }
    if (yaml::Entry* expect = entry_of(root_, "expect")) {
      std::erase_if(expect->value.items, [&](const yaml::Node& item) {
        const yaml::Node* where = item.find("where");
        return where != nullptr &&
               std::any_of(where->entries.begin(), where->entries.end(), [&](const auto& entry) {
                 return is_left_out(entry.key, entry.value.scalar);
               });
      });
    }
  }

  void problem(yaml::Position at, std::string message) {
    problems_.push_back({at, std::move(message)});
  }

  yaml::Node& root_;
  std::vector<yaml::Problem>& problems_;
};

/// The path of a setting, followed into the plan.
class PathReader {
 public:
  PathReader(const std::string& setting, std::vector<yaml::Problem>& problems)
      : setting_(setting), equals_(setting.find('=')), problems_(problems) {}

  yaml::Node read(const yaml::Node& root) {
    auto value = value_of_setting(setting_, equals_, problems_);
    if (!value) return {};
    value_ = *std::move(value);
    return from(0, &root, {});
  }

 private:
  /// The map that the rest of the path from `start` on merges into `base`, the value of
  /// `container`.
  yaml::Node from(std::size_t start, const yaml::Node* base, const std::string& container) {
    const std::string rest = setting_.substr(start, equals_ - start);
    std::string key = rest.substr(0, rest.find('.'));
    if (container == "set") key = rest;  // a setting of a pipeline contains dots
    yaml::Node copy = base != nullptr ? *base : yaml::Node{};
    const yaml::Entry* own = first_in(copy, rest);
    if (own != nullptr) key = own->key;
    const bool named = container == "axes" || container == "data" || container == "values";
    const bool missing = named && own == nullptr;
    if (key.empty() || missing) {
      const std::string what = container == "axes"   ? "axis"
                               : container == "data" ? "data"
                                                     : "value";
      problems_.push_back({at(start), key.empty() ? "expected a name before '.' or '='"
                                                  : "the plan has no " + what + " " + quote(key) +
                                                        did_you_mean(key, keys_of(base))});
      return {};
    }
    const std::size_t next = start + key.size() + 1;
    yaml::Node map;
    map.kind = yaml::Kind::map;
    map.at = at(start);
    map.entries.push_back({key, map.at, {}});
    map.entries.front().value =
        next > equals_ ? value_ : from(next, own != nullptr ? &own->value : nullptr, key);
    return map;
  }

  yaml::Position at(std::size_t start) const { return {1, columns(setting_.substr(0, start)) + 1}; }

  const std::string& setting_;
  std::size_t equals_;
  yaml::Node value_;
  std::vector<yaml::Problem>& problems_;
};

}  // namespace

PlanChanges PlanChanges::from(std::vector<std::string>& settings,
                              std::vector<std::string> without) {
  PlanChanges changes{{}, std::move(without)};
  const std::vector<std::string> keys = settable_keys();
  std::erase_if(settings, [&](const std::string& setting) {
    const std::string first = setting.substr(0, setting.find_first_of(".="));
    const bool of_plan = setting.find('=') != std::string::npos &&
                         std::find(keys.begin(), keys.end(), first) != keys.end();
    if (of_plan) changes.settings.push_back(setting);
    return of_plan;
  });
  return changes;
}

void leave_out_of_plan(yaml::Node& root, const yaml::Node& names,
                       std::vector<yaml::Problem>& problems) {
  if (names.kind != yaml::Kind::sequence) {
    problems.push_back(
        {names.at, "'without' must be a list of names: AXIS, AXIS.VALUE or data.NAME"});
    return;
  }
  for (const yaml::Node& name : names.items) LeavingOut(root, problems).leave_out(name);
}

yaml::Node plan_overlay_of(const std::string& setting, const yaml::Node& root,
                           std::vector<yaml::Problem>& problems) {
  return PathReader(setting, problems).read(root);
}

}  // namespace weft::lab
