// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <weft/data/template.hpp>

namespace weft::cli {

/// The mesh over the texture, which is pale outside the mask, and beside it, where the object is
/// not flat, the object from the front, from the left and above: a PNG of at most 1600 px a panel.
/// Empty where Cairo failed.
std::string draw_template(const Template& templ);

/// The texture alone as PNG.
std::string draw_texture(const Template& templ);

}  // namespace weft::cli
