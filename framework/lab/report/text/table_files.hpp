// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>
#include <weft/core/result.hpp>

#include "lab/report/text/text_table.hpp"

namespace weft::lab {

/// Writes each table as ID.csv into the folder, which is made where it is missing, and all behind
/// `head` as tables.md. Returns the files.
Result<std::vector<std::string>> write_table_files(const std::string& folder, std::string head,
                                                   std::vector<TextTable> tables);

}  // namespace weft::lab
