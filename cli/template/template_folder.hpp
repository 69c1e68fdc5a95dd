// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <weft/data/template.hpp>

#include "cli/commands.hpp"
#include "host/loading/component_spec.hpp"

namespace weft::cli {

/// Writes template.obj, texture.png and drawing.png of a template into a folder that is there; of a
/// mesh made anew also map.npz, where both meshes lie on each other. `crop_px` leaves so much of
/// the texture beside the object.
Result<void> write_template(const host::Registry& registry, const host::ComponentSpec& component,
                            const Template& templ, std::optional<double> crop_px,
                            const std::string& folder);

}  // namespace weft::cli
