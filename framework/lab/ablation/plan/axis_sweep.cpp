// SPDX-License-Identifier: Apache-2.0
#include "lab/ablation/plan/axis_sweep.hpp"

#include <algorithm>
#include <cmath>

#include "lab/statistics/unknown.hpp"

namespace weft::lab {
namespace {

constexpr std::size_t kLeastNumbers = 3;

double finite_or_unknown(const yaml::Node& node) {
  const auto number = yaml::as_double(node);
  return number && std::isfinite(*number) ? *number : kUnknown;
}

/// Values of an axis that set the same but for one number.
struct Family {
  std::string setting;  ///< the number's
  yaml::Node others;    ///< the other settings
  std::vector<std::size_t> values;
  std::vector<double> numbers;
};

/// The settings of a value that does nothing else, or nullptr.
const yaml::Node* settings_of(const NamedPatch& value) {
  return value.patch.entries.size() == 1 ? value.patch.find("set") : nullptr;
}

/// Every family of every value; a value with several numbers is in several.
std::vector<Family> families_of(const Axis& axis) {
  std::vector<Family> families;
  for (std::size_t v = 0; v < axis.values.size(); ++v) {
    const yaml::Node* settings = settings_of(axis.values[v]);
    for (std::size_t e = 0; settings != nullptr && e < settings->entries.size(); ++e) {
      const yaml::Entry& entry = settings->entries[e];
      const double number = finite_or_unknown(entry.value);
      if (std::isnan(number)) continue;
      yaml::Node others = *settings;
      others.entries.erase(others.entries.begin() + static_cast<std::ptrdiff_t>(e));
      auto family = std::find_if(families.begin(), families.end(), [&](const Family& known) {
        return known.setting == entry.key && known.others == others;
      });
      if (family == families.end()) {
        family = families.insert(families.end(), Family{entry.key, std::move(others), {}, {}});
      }
      family->values.push_back(v);
      family->numbers.push_back(number);
    }
  }
  return families;
}

/// The common prefix of the names of a family's values, without digits and signs at its end.
std::string name_of(const Axis& axis, const Family& family) {
  std::string common = axis.values[family.values.front()].name;
  for (const std::size_t value : family.values) {
    const std::string& name = axis.values[value].name;
    const auto [end, other] = std::mismatch(common.begin(), common.end(), name.begin(), name.end());
    common.erase(end, common.end());
  }
  const std::size_t last = common.find_last_not_of("0123456789._- =");
  common.resize(last == std::string::npos ? 0 : last + 1);
  return common.empty() ? family.setting : common;
}

std::optional<AxisSweep> by_names(const Axis& axis) {
  AxisSweep sweep{axis.name, {}, {}};
  for (const NamedPatch& value : axis.values) {
    sweep.numbers.push_back(finite_or_unknown(yaml::plain_node(value.name)));
    if (std::isnan(sweep.numbers.back())) return std::nullopt;
  }
  if (sweep.numbers.size() < kLeastNumbers) return std::nullopt;
  return sweep;
}

}  // namespace

std::optional<AxisSweep> sweep_of(const Axis& axis) {
  if (auto sweep = by_names(axis)) return sweep;
  std::vector<Family> families = families_of(axis);
  std::erase_if(families, [](const Family& each) { return each.values.size() < kLeastNumbers; });
  if (families.empty()) return std::nullopt;
  std::stable_sort(families.begin(), families.end(), [](const Family& a, const Family& b) {
    return a.values.size() > b.values.size();
  });
  const std::size_t count = axis.values.size();
  AxisSweep sweep{families.front().setting, std::vector<double>(count, kUnknown),
                  std::vector<std::string>(count)};
  for (const Family& family : families) {
    if (family.setting != sweep.name) sweep.name = "threshold";
    for (std::size_t k = 0; k < family.values.size(); ++k) {
      double& number = sweep.numbers[family.values[k]];
      if (!std::isnan(number)) continue;
      number = family.numbers[k];
      sweep.families[family.values[k]] = name_of(axis, family);
    }
  }
  if (families.size() == 1) sweep.families.clear();
  return sweep;
}

}  // namespace weft::lab
