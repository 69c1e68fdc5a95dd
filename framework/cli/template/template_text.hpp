// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "pipeline/survey/template_survey.hpp"
#include "pipeline/survey/texture_survey.hpp"

namespace weft::cli {

/// As lines for the terminal.
std::string numbers_text(const TemplateSurvey& survey);
nlohmann::ordered_json numbers_json(const TemplateSurvey& survey);

/// The same of its texture, without warnings.
std::string texture_text(const TextureSurvey& survey);
nlohmann::ordered_json texture_json(const TextureSurvey& survey);

}  // namespace weft::cli
