// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <weft/data/template.hpp>

#include "cli/commands.hpp"
#include "host/loading/component_spec.hpp"

namespace weft::cli {

/// Width and height of a texture.
using TextureSize = std::array<std::int64_t, 2>;

/// Writes template.obj, texture.png and drawing.png of a template into a folder that is there.
Result<TextureSize> write_template(const host::Registry& registry, const Template& templ,
                                   const std::string& folder);

/// The same; for a new mesh also map.npz, with the positions of each mesh on the other. `crop_px`
/// is the margin of the texture that is kept beside the object.
Result<TextureSize> write_template(const host::Registry& registry,
                                   const host::ComponentSpec& component, const Template& templ,
                                   std::optional<double> crop_px, const std::string& folder);

}  // namespace weft::cli
