// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdio>
#include <string_view>

#include "kit/testing/contract_subject.hpp"

namespace weft::testing {
namespace {

/// Factors of lengths in the image and in space.
struct Units {
  double px = 1.0, m = 1.0;
};

/// Factor of "px", "px^2", "m", "mm"; 1 of any other unit, such as "px of the texture".
double factor_of_part(std::string_view part, const Units& units) {
  const std::size_t power = part.find('^');
  const std::string_view base = part.substr(0, power);
  const double factor = base == "px" ? units.px : base == "m" || base == "mm" ? units.m : 1.0;
  if (power == std::string_view::npos) return factor;
  return std::pow(factor, std::atof(std::string(part.substr(power + 1)).c_str()));
}

double factor_of(std::string_view unit, const Units& units) {
  if (unit.find(' ') != std::string_view::npos) return 1.0;
  const std::size_t slash = unit.find('/');
  const double above = factor_of_part(unit.substr(0, slash), units);
  if (slash == std::string_view::npos) return above;
  return above / factor_of_part(unit.substr(slash + 1), units);
}

void scale(yaml::Node& value, const host::ParameterSpec& parameter, double factor) {
  for (yaml::Node& item : value.items) scale(item, parameter, factor);
  const auto number = value.kind == yaml::Kind::scalar ? yaml::as_double(value) : std::nullopt;
  if (!number) return;
  char text[40];
  const bool whole = parameter.type == WEFT_VALUE_I64;
  std::snprintf(text, sizeof(text), whole ? "%.0f" : "%.17g", factor * *number);
  value.scalar = text;
}

/// A component's {use, params}, and those nested in it.
void scale(yaml::Node& use, const host::ComponentSpec& spec, const Units& units) {
  for (yaml::Entry& entry : use.entries) {
    if (entry.key != "params") continue;
    for (yaml::Entry& value : entry.value.entries) {
      for (const host::ParameterSpec& parameter : spec.component().parameters) {
        const double factor = factor_of(parameter.unit, units);
        if (parameter.name == value.key && factor != 1.0) scale(value.value, parameter, factor);
      }
      for (const host::NestedSpec& nested : spec.nested) {
        if (nested.parameter == value.key) scale(value.value, nested.component, units);
      }
    }
  }
}

Result<host::ComponentSpec> scaled(const host::Registry& registry, const host::ComponentSpec& spec,
                                   const Units& units) {
  yaml::Node wanted = spec.effective;
  scale(wanted, spec, units);
  std::vector<yaml::Problem> problems;
  auto made = host::resolve_component(registry, *wanted.find("use"), wanted.find("params"),
                                      host::PathRules::of_process({"/"}, "/"), problems);
  if (made && problems.empty()) return *std::move(made);
  return Error{Errc::invalid_value,
               problems.empty() ? "it cannot be made in other units" : problems.front().message,
               spec.component().id};
}

}  // namespace

Result<Subject> Subject::in_units(double px, double m) const {
  auto spec = scaled(*registry_, spec_, {px, m});
  if (!spec) return spec.error();
  Subject subject(*registry_, *std::move(spec));
  if (!warp_maker) return subject;
  auto maker = scaled(*registry_, *warp_maker, {px, m});
  if (!maker) return maker.error();
  subject.warp_maker = *std::move(maker);
  return subject;
}

}  // namespace weft::testing
