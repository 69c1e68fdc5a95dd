// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <map>
#include <set>
#include <weft/core/quote.hpp>

#include "ablation/plan/plan_parts.hpp"

namespace weft::evaluation {
namespace {

class AxesReader {
 public:
  AxesReader(PlanValues& values, std::set<std::string>& broken)
      : values_(values), broken_(broken) {}

  std::vector<Axis> read(const yaml::Node& axes) {
    std::vector<Axis> all;
    if (axes.kind != yaml::Kind::map) {
      values_.problem(axes.at, "'axes' must be a map of names and values");
    }
    for (const yaml::Entry& entry : axes.entries) {
      const std::vector<std::string> taken{"data", "sequence", "seed", "cell", "key"};
      if (std::find(taken.begin(), taken.end(), entry.key) != taken.end()) {
        values_.problem(entry.at, "an axis must not be called " + quote(entry.key) +
                                      ", which has a meaning of its own");
      }
      values_.is_name(entry.key, entry.at, "the name of an axis");
      const std::size_t before = values_.count();
      std::vector<NamedPatch> values;
      if (values_.is_map(entry.value, "an axis", {"set", "values"}) &&
          values_.has(entry.value, "values", "an axis")) {
        values = values_of(entry.value);
      }
      if (values_.count() > before) broken_.insert(entry.key);
      if (const yaml::Node* set = entry.value.find("set")) refuse_same_setting(entry.key, *set);
      if (!values.empty()) all.push_back({entry.key, std::move(values)});
    }
    return all;
  }

 private:
  /// Of two axes with one setting the later would always win.
  void refuse_same_setting(const std::string& axis, const yaml::Node& set) {
    std::string path = set.scalar;
    const std::size_t dot = path.find('.');  // `params` may be left out of a path
    if (dot != std::string::npos && path.compare(dot, 8, ".params.") == 0) path.erase(dot, 7);
    const auto [first, is_new] = settings_.emplace(path, axis);
    if (is_new || path.empty()) return;
    values_.problem(set.at, "the axis '" + first->second + "' sets " + quote(path) + " too");
  }

  std::vector<NamedPatch> values_of(const yaml::Node& axis) {
    const yaml::Node* set = axis.find("set");
    const yaml::Node& given = *axis.find("values");
    const std::string path = set != nullptr ? values_.text(*set, "'set' of an axis") : "";
    std::vector<NamedPatch> found;
    for (const yaml::Node& item : set != nullptr ? given.items : std::vector<yaml::Node>{}) {
      found.push_back({values_.text(item, "a value of an axis"), {}});
      if (set != nullptr) found.back().patch = setting_patch(path, set->at, item);
      check_value(found, item.at);
    }
    for (const yaml::Entry& entry : given.entries) {
      found.push_back({entry.key, set != nullptr ? setting_patch(path, set->at, entry.value)
                                                 : patch_of(entry.value)});
      check_value(found, entry.at);
    }
    if (given.kind == yaml::Kind::sequence && set == nullptr) {
      values_.problem(given.at,
                      "an axis whose values are a list needs 'set', the setting they are for");
    } else if (found.empty()) {
      values_.problem(given.at, "an axis needs values: a list, or a map of names and patches");
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
    if (!values_.is_map(node, "a value of an axis", patch_keys())) return {};
    if (yaml::is_null(node)) return {};
    return patch_in(node, values_);
  }

  PlanValues& values_;
  std::set<std::string>& broken_;
  std::map<std::string, std::string> settings_;  ///< the axis of each
};

}  // namespace

std::vector<Axis> read_axes(const yaml::Node& node, PlanValues& values,
                            std::set<std::string>& broken) {
  return AxesReader(values, broken).read(node);
}

}  // namespace weft::evaluation
