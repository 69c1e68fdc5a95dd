// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cli/commands.hpp"
#include "host/loading/component_spec.hpp"

namespace weft::cli {

/// Which template a command is about: that of a pipeline, of a plugin, or of a photograph, which
/// stands for --use templates/photo and its parameters.
struct ChosenTemplate {
  std::string pipeline, use, photo;
  std::vector<std::string> settings;
  std::optional<double> width_m, height_m;  ///< size of the object in the photograph
  std::string camera, corners;              ///< camera and corners of the photograph
};

/// The options that choose a template.
void add_choice(CLI::App& command, ChosenTemplate& chosen);

/// The component that builds it; prints errors.
std::optional<host::ComponentSpec> component_of(const ChosenTemplate& chosen,
                                                const host::Registry& registry);

}  // namespace weft::cli
