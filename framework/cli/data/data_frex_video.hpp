// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "cli/commands.hpp"
#include "cli/output/generated_text.hpp"

namespace weft::cli {

/// Arguments of `weft data make frex --video`.
struct FrexVideoRequest {
  std::string video, camera, layout, texture, background;
  std::int64_t seed = 1;
};

/// The pipeline that puts `texture` on the filmed paper with markers: sources/frex_video into
/// sinks/dataset. Paths in it are absolute. Fails if the texture or the layout cannot be read.
Result<GeneratedText> frex_video_pipeline(const Context& context, const FrexVideoRequest& request);

}  // namespace weft::cli
