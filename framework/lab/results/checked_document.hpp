// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <weft/core/result.hpp>

namespace weft::lab {

/// The object, indented so far, with a last member `check`: XXH128 of its canonical JSON without
/// it. Ends with a line break.
std::string checked_document(nlohmann::ordered_json object, int indent);

/// Fails where the object, read from `file`, has a check that is not its own. Those that older
/// programs wrote have none.
Result<void> compare_check(nlohmann::json object, const std::string& file);

}  // namespace weft::lab
