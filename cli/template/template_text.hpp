// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "pipeline/survey/template_survey.hpp"

namespace weft::cli {

/// As lines for the terminal.
std::string numbers_text(const TemplateSurvey& survey);
nlohmann::ordered_json numbers_json(const TemplateSurvey& survey);

}  // namespace weft::cli
