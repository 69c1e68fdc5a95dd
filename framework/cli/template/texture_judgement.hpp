// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "cli/commands.hpp"
#include "pipeline/survey/texture_survey.hpp"

namespace weft::cli {

/// Assesses the texture of a template with the features of the default pipeline. Fails if these are
/// not installed.
Result<TextureSurvey> judge_texture(const host::Registry& registry, const host::Record& templ,
                                    const TemplateSurvey& numbers);

/// Writes an image of the keypoints that look alike, as PNG.
Result<void> write_twins(const host::Registry& registry, const host::Record& templ,
                         const TextureSurvey& texture, const std::string& path);

}  // namespace weft::cli
