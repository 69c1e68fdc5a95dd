// SPDX-License-Identifier: Apache-2.0
#include "axis_sweep.hpp"

#include <algorithm>
#include <cmath>
#include <weft/evaluation/unknown.hpp>

namespace weft::evaluation {
namespace {

constexpr std::ptrdiff_t kLeastNumbers = 3;

double finite_or_unknown(const yaml::Node& node) {
  const auto number = yaml::as_double(node);
  return number && std::isfinite(*number) ? *number : kUnknown;
}

/// The one setting that a value changes, or nullptr.
const yaml::Entry* only_setting(const NamedPatch& value) {
  if (value.patch.entries.size() != 1) return nullptr;
  const yaml::Node* set = value.patch.find("set");
  return set != nullptr && set->entries.size() == 1 ? &set->entries.front() : nullptr;
}

AxisSweep by_names(const Axis& axis) {
  AxisSweep sweep{axis.name, {}};
  for (const NamedPatch& value : axis.values) {
    sweep.numbers.push_back(finite_or_unknown(yaml::plain_node(value.name)));
  }
  return sweep;
}

AxisSweep by_setting(const Axis& axis, const std::string& setting) {
  AxisSweep sweep{setting, {}};
  for (const NamedPatch& value : axis.values) {
    const yaml::Entry* set = only_setting(value);
    const bool same = set != nullptr && set->key == setting;
    sweep.numbers.push_back(same ? finite_or_unknown(set->value) : kUnknown);
  }
  return sweep;
}

std::ptrdiff_t count_of(const AxisSweep& sweep) {
  return std::count_if(sweep.numbers.begin(), sweep.numbers.end(),
                       [](double number) { return std::isfinite(number); });
}

}  // namespace

std::optional<AxisSweep> sweep_of(const Axis& axis) {
  AxisSweep best = by_names(axis);
  if (count_of(best) < static_cast<std::ptrdiff_t>(axis.values.size())) best = {};
  for (const NamedPatch& value : axis.values) {
    const yaml::Entry* set = only_setting(value);
    if (set == nullptr) continue;
    AxisSweep sweep = by_setting(axis, set->key);
    if (count_of(sweep) > count_of(best)) best = std::move(sweep);
  }
  if (count_of(best) < kLeastNumbers) return std::nullopt;
  return best;
}

}  // namespace weft::evaluation
