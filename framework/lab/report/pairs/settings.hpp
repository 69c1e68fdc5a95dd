// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "lab/report/text/text_table.hpp"

namespace weft::lab {

/// The settings in which two effective configurations (YAML) differ, a row each. Entries of lists
/// are matched by their `as`, else by their `use`.
TextTable settings_sheet(const std::string& a, const std::string& b);

/// Both have the same source with the same parameters, so that equal frame numbers are equal
/// frames.
bool have_same_source(const std::string& a, const std::string& b);

}  // namespace weft::lab
