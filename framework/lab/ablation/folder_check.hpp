// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>
#include <weft/core/result.hpp>

namespace weft::lab {

/// Checks that `path` is free for the results of a plan of this name, or already has results of it.
/// A power cut or a full disk may leave manifest.json or plan.json missing, empty or truncated.
/// Such a folder is usable: returns a sentence for each of these files, which
/// ResultsFolder::describe() rewrites.
Result<std::vector<std::string>> check_results_folder(const std::string& path,
                                                      const std::string& plan);

}  // namespace weft::lab
