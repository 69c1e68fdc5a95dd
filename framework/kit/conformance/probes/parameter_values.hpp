// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>
#include <weft/core/result.hpp>
#include <weft/core/rng.hpp>

#include "host/loading/arguments.hpp"
#include "host/loading/manifest.hpp"

/// Values of parameters, legal and not.
namespace weft::conformance {

/// The map that a text of parameters gives.
Result<yaml::Node> parsed_params(const std::string& text);

/// The map with another value of one key.
yaml::Node with(const yaml::Node& params, const std::string& name, const yaml::Node& value);

/// Why a default is none of the legal values; empty where it is one.
std::string default_mistake(const host::ParameterSpec& parameter);

/// Both ends of a range, both values of a flag, all choices; empty for others.
std::vector<yaml::Node> end_values(const host::ParameterSpec& parameter);

/// True if values can be sampled: for a number, a flag or a choice.
bool can_draw(const host::ParameterSpec& parameter);
yaml::Node draw(const host::ParameterSpec& parameter, Rng& rng);

/// A value that a component must refuse, with those of its parameters that are required.
struct Illegal {
  std::string parameter, what;
  host::Arguments arguments;
};
std::vector<Illegal> beyond_range(const host::ComponentManifest& component);
std::vector<Illegal> wrong_types(const host::ComponentManifest& component);

}  // namespace weft::conformance
