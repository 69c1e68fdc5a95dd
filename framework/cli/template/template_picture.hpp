// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include "cli/commands.hpp"
#include "host/records/record.hpp"

namespace weft::cli {

enum class Picture {
  mesh,     ///< over the texture, with the object where it is not flat
  texture,  ///< alone
  matches,  ///< matches of a frame, with its shape
  twins,    ///< keypoints of the texture that look alike, given as matches with itself
};

/// Renders a template to a PNG file with sinks/drawing.
Result<void> write_picture(const host::Registry& registry, const host::Record& templ,
                           Picture picture, const std::string& path);

/// The same with all other contents of the image.
Result<void> write_picture(const host::Registry& registry, std::span<const weft_record> inputs,
                           Picture picture, const std::string& path);

}  // namespace weft::cli
