// SPDX-License-Identifier: Apache-2.0
#include "kit/conformance/probes/parameter_values.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace weft::conformance {
namespace {

using host::ParameterSpec;

constexpr std::int64_t kMostInteger = 1LL << 53;  ///< limit of integers that a double represents
                                                  ///< exactly

bool is_number(const ParameterSpec& parameter) {
  return parameter.type == WEFT_VALUE_F64 || parameter.type == WEFT_VALUE_I64;
}

yaml::Node number_node(const ParameterSpec& parameter, double value) {
  if (parameter.type == WEFT_VALUE_I64) {
    return yaml::plain_node(fmt::format("{}", static_cast<std::int64_t>(value)));
  }
  return yaml::plain_node(fmt::format("{:.17g}", value));
}

/// Values that a number, or an entry of a list of numbers, must not have.
std::vector<double> numbers_beyond(const ParameterSpec& parameter) {
  if (parameter.type == WEFT_VALUE_I64) {
    std::vector<double> beyond;
    const bool holds = std::abs(parameter.minimum) < kMostInteger && parameter.bounded;
    if (holds) beyond.push_back(parameter.minimum - 1.0);
    if (parameter.bounded && parameter.maximum < kMostInteger) {
      beyond.push_back(parameter.maximum + 1.0);
    }
    return beyond;
  }
  std::vector<double> beyond = {std::numeric_limits<double>::quiet_NaN()};
  constexpr double kEndless = std::numeric_limits<double>::infinity();
  if (parameter.bounded && std::isfinite(parameter.minimum)) {
    beyond.push_back(std::nextafter(parameter.minimum, -kEndless));
    beyond.push_back(-kEndless);
  }
  if (parameter.bounded && std::isfinite(parameter.maximum)) {
    beyond.push_back(std::nextafter(parameter.maximum, kEndless));
    beyond.push_back(kEndless);
  }
  return beyond;
}

/// A legal value of a parameter that must be given.
void add_required(const ParameterSpec& parameter, host::Arguments& arguments) {
  const double low =
      parameter.bounded && std::isfinite(parameter.minimum) ? parameter.minimum : 1.0;
  switch (parameter.type) {
    case WEFT_VALUE_F64:
      if (parameter.is_vector) return arguments.add_numbers(parameter.name, {low});
      return arguments.add_number(parameter.name, low);
    case WEFT_VALUE_I64:
      return arguments.add_integer(parameter.name, static_cast<std::int64_t>(low));
    case WEFT_VALUE_CHOICE:
      return arguments.add_texts(parameter.name, parameter.type, {parameter.choices.front()});
    case WEFT_VALUE_TEXT:
    case WEFT_VALUE_INPUT_PATH:
    case WEFT_VALUE_OUTPUT_PATH:
      return arguments.add_texts(parameter.name, parameter.type, {"/nowhere"});
    default:
      return;
  }
}

Illegal illegal_of(const host::ComponentManifest& component, const ParameterSpec& about,
                   std::string what) {
  Illegal illegal{about.name, std::move(what), {}};
  for (const ParameterSpec& parameter : component.parameters) {
    if (parameter.required && parameter.name != about.name) {
      add_required(parameter, illegal.arguments);
    }
  }
  return illegal;
}

}  // namespace

Result<yaml::Node> parsed_params(const std::string& text) {
  const auto document = yaml::parse("params: " + text + "\n", "params");
  if (!document) return document.error();
  if (!document->problems.empty()) {
    return Error{Errc::syntax, document->problems.front().message, {}};
  }
  return *document->root.find("params");
}

yaml::Node with(const yaml::Node& params, const std::string& name, const yaml::Node& value) {
  yaml::Node changed = params;
  changed.kind = yaml::Kind::map;
  for (yaml::Entry& entry : changed.entries) {
    if (entry.key != name) continue;
    entry.value = value;
    return changed;
  }
  changed.entries.push_back({name, {}, value});
  return changed;
}

std::string default_mistake(const ParameterSpec& parameter) {
  if (parameter.required) return "";
  const yaml::Node& value = parameter.default_value;
  if (parameter.type == WEFT_VALUE_CHOICE) {
    const auto& all = parameter.choices;
    const bool known = std::find(all.begin(), all.end(), value.scalar) != all.end();
    return known ? "" : "its default '" + value.scalar + "' is none of its choices";
  }
  if (parameter.type == WEFT_VALUE_BOOL && !yaml::as_bool(value)) return "its default is no flag";
  if (!is_number(parameter)) return "";
  std::vector<yaml::Node> numbers = parameter.is_vector ? value.items : std::vector{value};
  for (const yaml::Node& each : numbers) {
    const auto number = yaml::as_double(each);
    if (!number || std::isnan(*number)) return "its default '" + each.scalar + "' is no number";
    const bool within =
        !parameter.bounded || (*number >= parameter.minimum && *number <= parameter.maximum);
    if (!within) {
      return fmt::format("its default {} is outside {} to {}", each.scalar, parameter.minimum,
                         parameter.maximum);
    }
  }
  return "";
}

std::vector<yaml::Node> end_values(const ParameterSpec& parameter) {
  std::vector<yaml::Node> values;
  if (parameter.type == WEFT_VALUE_BOOL) {
    values = {yaml::plain_node("false"), yaml::plain_node("true")};
  }
  if (parameter.type == WEFT_VALUE_CHOICE) {
    for (const std::string& choice : parameter.choices) values.push_back(yaml::text_node(choice));
  }
  if (!is_number(parameter) || parameter.is_vector || !parameter.bounded) return values;
  for (const double end : {parameter.minimum, parameter.maximum}) {
    if (std::isfinite(end)) values.push_back(number_node(parameter, end));
  }
  return values;
}

bool can_draw(const ParameterSpec& parameter) {
  if (parameter.type == WEFT_VALUE_BOOL) return true;
  if (parameter.type == WEFT_VALUE_CHOICE) return parameter.choices.size() > 1;
  return is_number(parameter) && !parameter.is_vector;
}

yaml::Node draw(const ParameterSpec& parameter, Rng& rng) {
  if (parameter.type == WEFT_VALUE_BOOL)
    return yaml::plain_node(rng.below(2) == 1 ? "true" : "false");
  if (parameter.type == WEFT_VALUE_CHOICE) {
    const auto count = static_cast<std::uint32_t>(parameter.choices.size());
    return yaml::text_node(parameter.choices[rng.below(count)]);
  }
  const double usual = yaml::as_double(parameter.default_value).value_or(1.0);
  const double spread = std::max(4.0 * std::abs(usual), 1.0);
  const bool has_low = parameter.bounded && std::isfinite(parameter.minimum);
  const bool has_high = parameter.bounded && std::isfinite(parameter.maximum);
  const double low = has_low ? parameter.minimum : usual - spread;
  const double high = has_high ? parameter.maximum : usual + spread;
  // As often near what is usual as anywhere: a range may end far from all that makes sense.
  const bool near = rng.below(2) == 1;
  const double from = near ? std::max(low, usual - spread) : low;
  const double to = near ? std::min(high, usual + spread) : high;
  const double value = std::clamp(rng.uniform(from, std::max(from, to)), low, std::max(low, high));
  return number_node(parameter, parameter.type == WEFT_VALUE_I64 ? std::floor(value) : value);
}

std::vector<Illegal> beyond_range(const host::ComponentManifest& component) {
  std::vector<Illegal> all;
  for (const ParameterSpec& parameter : component.parameters) {
    if (parameter.type == WEFT_VALUE_CHOICE) {
      all.push_back(illegal_of(component, parameter, "a word that is none of its choices"));
      all.back().arguments.add_texts(parameter.name, parameter.type, {"x_no_such_choice"});
    }
    if (!is_number(parameter)) continue;
    for (const double number : numbers_beyond(parameter)) {
      all.push_back(illegal_of(component, parameter, fmt::format("{:.17g}", number)));
      host::Arguments& arguments = all.back().arguments;
      if (parameter.is_vector)
        arguments.add_numbers(parameter.name, {number});
      else if (parameter.type == WEFT_VALUE_I64)
        arguments.add_integer(parameter.name, static_cast<std::int64_t>(number));
      else
        arguments.add_number(parameter.name, number);
    }
  }
  return all;
}

std::vector<Illegal> wrong_types(const host::ComponentManifest& component) {
  std::vector<Illegal> all;
  for (const ParameterSpec& parameter : component.parameters) {
    if (parameter.type == WEFT_VALUE_TEXT) {
      all.push_back(illegal_of(component, parameter, "a number instead of a text"));
      all.back().arguments.add_number(parameter.name, 1.0);
    } else {
      all.push_back(illegal_of(component, parameter, "a text"));
      all.back().arguments.add_texts(parameter.name, WEFT_VALUE_TEXT, {"text"});
    }
  }
  return all;
}

}  // namespace weft::conformance
