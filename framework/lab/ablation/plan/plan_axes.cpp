// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <map>
#include <set>
#include <weft/core/quote.hpp>
#include <weft/core/suggest.hpp>

#include "lab/ablation/plan/plan_keys.hpp"
#include "lab/ablation/plan/plan_parts.hpp"

namespace weft::lab {
namespace {

class AxesReader {
 public:
  AxesReader(const host::Registry& registry, PlanValues& values, std::set<std::string>& broken)
      : registry_(registry), values_(values), broken_(broken) {}

  std::vector<Axis> read(const yaml::Node& axes) {
    std::vector<Axis> all;
    if (axes.kind != yaml::Kind::map) {
      values_.problem(axes.at, "'axes' must be a map of names and values");
    }
    for (const yaml::Entry& entry : axes.entries) {
      const std::vector<std::string>& taken = reserved_axis_names();
      if (std::find(taken.begin(), taken.end(), entry.key) != taken.end()) {
        values_.problem(entry.at, "an axis must not be called " + quote(entry.key) +
                                      ", which is a reserved name");
      }
      values_.is_name(entry.key, entry.at, "the name of an axis");
      const std::size_t before = values_.count();
      in_patches_ = 0;
      std::vector<NamedPatch> values = values_of(entry.value);
      if (values_.count() > before + in_patches_) broken_.insert(entry.key);
      refuse_same_setting(entry);
      if (!values.empty()) all.push_back({entry.key, std::move(values)});
    }
    return all;
  }

 private:
  /// Refuses two axes with one setting: the later would always win.
  void refuse_same_setting(const yaml::Entry& axis) {
    const bool components = axis.value.find("use") != nullptr;
    const yaml::Node* set = axis.value.find(components ? "stage" : "set");
    if (set == nullptr || set->scalar.empty()) return;
    std::string path = set->scalar + (components ? ".use" : "");
    const std::size_t dot = path.find('.');  // `params` may be omitted in a path
    if (dot != std::string::npos && path.compare(dot, 8, ".params.") == 0) path.erase(dot, 7);
    const auto [first, is_new] = settings_.emplace(path, axis.key);
    if (is_new) return;
    values_.problem(set->at, "the axis " + quote(first->second) + " sets " + quote(path) + " too");
  }

  std::vector<NamedPatch> values_of(const yaml::Node& axis) {
    const yaml::Node* given = axis.find("values");
    if (axis.find("use") != nullptr) {
      if (!values_.is_map(axis, "an axis", component_axis_keys())) return {};
      std::vector<NamedPatch> found;
      if (given != nullptr && given->kind != yaml::Kind::map && !yaml::is_null(*given)) {
        values_.problem(given->at, "'values' beside 'use' must be a map of names and patches");
      } else if (given != nullptr) {
        add_patches(*given, found);
      }
      for (NamedPatch& value : component_values(axis, registry_, values_)) {
        found.push_back(std::move(value));
        check_value(found, axis.find("use")->at);
      }
      return found;
    }
    const bool legal = values_.is_map(axis, "an axis", axis_keys());
    if (!legal || !values_.has(axis, "values", "an axis")) return {};
    return axis.find("set") != nullptr ? of_setting(*axis.find("set"), *given) : of_patches(*given);
  }

  std::vector<NamedPatch> of_setting(const yaml::Node& set, const yaml::Node& given) {
    const std::string path = values_.text(set, "'set' of an axis");
    std::vector<NamedPatch> found;
    for (const yaml::Node& item : given.items) {
      found.push_back(
          {values_.text(item, "a value of an axis"), setting_patch(path, set.at, item)});
      check_value(found, item.at);
    }
    for (const yaml::Entry& entry : given.entries) {
      found.push_back({entry.key, setting_patch(path, set.at, entry.value)});
      check_value(found, entry.at);
    }
    if (found.empty()) refuse_none(given.at);
    return found;
  }

  std::vector<NamedPatch> of_patches(const yaml::Node& given) {
    std::vector<NamedPatch> found;
    add_patches(given, found);
    if (given.kind == yaml::Kind::sequence) {
      values_.problem(given.at,
                      "an axis whose values are a list needs 'set', the setting they are for");
    } else if (found.empty()) {
      refuse_none(given.at);
    }
    return found;
  }

  void refuse_none(yaml::Position at) {
    values_.problem(at, "an axis needs values: a list, or a map of names and patches");
  }

  void add_patches(const yaml::Node& given, std::vector<NamedPatch>& found) {
    for (const yaml::Entry& entry : given.entries) {
      const yaml::Node* sweep = entry.value.find("sweep");
      NamedPatch value{entry.key, patch_of(entry.value)};
      if (sweep == nullptr) {
        found.push_back(std::move(value));
        check_value(found, entry.at);
        continue;
      }
      for (NamedPatch& each : swept(value, *sweep)) {
        found.push_back(std::move(each));
        check_value(found, entry.at);
      }
    }
  }

  /// A value for each number of `sweep: {PATH: [NUMBERS]}`, called by it.
  std::vector<NamedPatch> swept(const NamedPatch& value, const yaml::Node& sweep) {
    std::vector<NamedPatch> found;
    if (sweep.entries.size() != 1 || sweep.entries.front().value.items.empty()) {
      values_.problem(sweep.at,
                      "'sweep' of a value must be one setting and its numbers, such as "
                      "{filters.alpha_s: [0.1, 0.2]}");
      return found;
    }
    const yaml::Entry& numbers = sweep.entries.front();
    for (const yaml::Node& number : numbers.value.items) {
      if (!values_.number(number, "a value of 'sweep'")) continue;
      found.push_back({value.name + "_" + number.scalar,
                       with_setting(value.patch, numbers.key, numbers.at, number)});
    }
    return found;
  }

  void check_value(const std::vector<NamedPatch>& values, yaml::Position at) {
    const std::string& name = values.back().name;
    const auto same = [&](const NamedPatch& value) { return value.name == name; };
    if (name.empty() || !values_.is_name(name, at, "the name of a value")) return;
    if (std::count_if(values.begin(), values.end(), same) > 1) {
      values_.problem(at, "the axis has the value " + quote(name) + " twice");
    }
  }

  yaml::Node patch_of(const yaml::Node& node) {
    const std::size_t before = values_.count();
    const bool legal = values_.is_map(node, "a value of an axis", axis_value_keys());
    yaml::Node patch = legal && !yaml::is_null(node) ? patch_in(node, values_) : yaml::Node();
    if (!may_be_swept(node)) in_patches_ += values_.count() - before;
    return patch;
  }

  /// True if a key is a misspelt `sweep`, which would have given the value other names.
  static bool may_be_swept(const yaml::Node& node) {
    const std::vector<std::string> keys = yaml::names_of(axis_value_keys());
    return std::any_of(node.entries.begin(), node.entries.end(), [&](const yaml::Entry& entry) {
      return entry.key != "sweep" && nearest(entry.key, keys) == "sweep";
    });
  }

  const host::Registry& registry_;
  PlanValues& values_;
  std::set<std::string>& broken_;
  std::map<std::string, std::string> settings_;  ///< the axis of each
  std::size_t in_patches_ = 0;  ///< errors of an axis that leave the names of its values known
};

}  // namespace

std::vector<Axis> read_axes(const yaml::Node& node, const host::Registry& registry,
                            PlanValues& values, std::set<std::string>& broken) {
  return AxesReader(registry, values, broken).read(node);
}

}  // namespace weft::lab
